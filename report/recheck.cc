#include "report/recheck.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>

namespace scancal {
namespace {

constexpr double kOfU = 1e-6, kOfNumber = 1e-6, kOfPlace = 1e-9;
const std::set<std::string> kPlaces = {"volume", "scene", "grid", "targets", "hand_eye"};
// Of a parameter, and known as well as it is.
const std::set<std::string> kLikeTheEstimate = {"value", "prior",   "nominal",  "u",     "U",         "mean",
                                                "low",   "gum_low", "gum_high", "edges", "tolerance", "high"};

std::string Cut(const Json& json) {
  constexpr size_t kLongest = 60;
  if (json.is_number_float()) return fmt::format("{:.9g}", json.get<double>());
  const std::string text = json.is_string() ? json.get<std::string>() : json.dump();
  return text.size() > kLongest ? text.substr(0, kLongest) + "..." : text;
}

// What an item of a list is found by, and called in messages.
std::string NameOf(const Json& item) {
  for (const char* key : {"name", "source", "without"})
    if (item.is_object() && item.contains(key) && item[key].is_string()) return item[key];
  return "";
}

struct Tolerance {
  double of_number = kOfNumber;  // relative
  double size = 0;               // of the largest number of a list
  double u = 0;                  // of the parameter; 0: of none
};

class Walker {
 public:
  Walker(const Json& again, bool same_keys) : same_keys_(same_keys) {
    for (const Json& parameter : again["parameters"])
      if (parameter["u"].is_number()) u_[parameter["name"]] = parameter["u"];
  }

  void Top(const std::string& key, const Json& found, const Json& again) {
    top_ = key;
    Walk(found, again, key, {kPlaces.contains(key) ? kOfPlace : kOfNumber});
  }

  void Parameter(const Json* found, const Json& again) {
    const std::string name = again["name"];
    if (found == nullptr) return Differ(name, "missing", Cut(again["value"]));
    top_ = "parameters";
    Keys(*found, again, {kOfPlace, 0, u_[name]},
         [&](const std::string& key) { return key == "value" ? name : key + " of " + name; });
  }

  Agreement agreement;

 private:
  void Differ(const std::string& where, const std::string& here, const std::string& there) {
    if (!agreement.first) agreement.first = {where, here, there};
  }

  void Number(const Json& found, const Json& again, const std::string& where, const Tolerance& tolerance) {
    const double here = found, there = again, off = std::abs(here - there);
    ++agreement.numbers;
    if (tolerance.u > 0) agreement.largest_in_u = std::max(agreement.largest_in_u, off / tolerance.u);
    const bool counted = found.is_number_integer() && again.is_number_integer();
    const double size = std::max({std::abs(here), std::abs(there), tolerance.size});
    const double allowed = counted ? 0 : tolerance.u > 0 ? kOfU * tolerance.u : tolerance.of_number * size;
    if (!(off <= allowed)) Differ(where, Cut(found), Cut(again));
  }

  void Walk(const Json& found, const Json& again, const std::string& where, const Tolerance& tolerance) {
    if (agreement.first) return;
    if (again.is_object() && found.is_object())
      Keys(found, again, tolerance, [&](const std::string& key) { return where + ": " + key; });
    else if (again.is_array() && found.is_array()) Items(found, again, where, tolerance);
    else if (again.is_number() && found.is_number()) Number(found, again, where, tolerance);
    else if (found != again) Differ(where, Cut(found), Cut(again));
  }

  template <class Naming>
  void Keys(const Json& found, const Json& again, Tolerance tolerance, const Naming& called) {
    const bool of_parameter = top_ == "parameters" || top_ == "montecarlo";
    const auto own = u_.find(NameOf(again));
    const double u = of_parameter && own != u_.end() ? own->second : tolerance.u;
    for (const auto& [key, value] : again.items()) {
      const auto named = u_.find(key);
      tolerance.u = top_ == "jackknife" && named != u_.end()         ? named->second
                    : of_parameter && kLikeTheEstimate.contains(key) ? u
                                                                     : 0;
      if (of_parameter) tolerance.of_number = kLikeTheEstimate.contains(key) ? kOfPlace : kOfNumber;
      if (found.contains(key)) Walk(found[key], value, called(key), tolerance);
      else if (same_keys_) Differ(called(key), "missing", Cut(value));
    }
    for (const auto& [key, value] : found.items())
      if (same_keys_ && !again.contains(key)) Differ(called(key), Cut(value), "nothing");
  }

  void Items(const Json& found, const Json& again, const std::string& where, Tolerance tolerance) {
    if (found.size() != again.size())
      return Differ(where, fmt::format("a list of {}", found.size()), fmt::format("one of {}", again.size()));
    for (const Json& each : again)
      if (each.is_number()) tolerance.size = std::max(tolerance.size, std::abs(each.get<double>()));
    for (size_t k = 0; k < again.size(); ++k) {
      const std::string name = NameOf(again[k]);
      Walk(found[k], again[k], where + ": " + (name.empty() ? std::to_string(k + 1) : name), tolerance);
    }
  }

  bool same_keys_;
  std::map<std::string, double> u_;  // of parameters
  std::string top_;                  // the file's key in hand
};

const Json* FindNamed(const Json& list, const std::string& name) {
  for (const Json& each : list)
    if (NameOf(each) == name) return &each;
  return nullptr;
}

}  // namespace

Agreement CompareResults(const Json& found, const Json& again, const RecheckChoice& choice) {
  Walker walker(again, choice.same_keys);
  for (const Json& parameter : again["parameters"])
    walker.Parameter(FindNamed(found["parameters"], NameOf(parameter)), parameter);
  if (choice.same_keys) walker.Top("parameters", found["parameters"].size(), again["parameters"].size());
  for (const auto& [key, value] : again.items()) {
    if (key == "parameters" || choice.without.contains(key)) continue;
    if (found.contains(key)) walker.Top(key, found[key], value);
    else if (choice.same_keys) walker.Top(key, "missing", value);
  }
  for (const auto& [key, value] : found.items())
    if (choice.same_keys && !again.contains(key) && !choice.without.contains(key)) walker.Top(key, value, "nothing");
  return walker.agreement;
}

}  // namespace scancal
