// A mapping of a YAML file, read field by field with exact complaints.
#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include "io/result.h"

namespace scancal {

struct YamlFile;
struct YamlNode;

// Reading never stops half way: every getter returns something harmless when its field is wrong, and the first thing
// that is wrong is remembered ("dataset.yaml:12:5: search: step: found "x", expected a number"). Finish() reports it,
// or any key in this file that nobody asked for (with the nearest known key). Copies share the file, its error and the
// list of taken keys.
class YamlMap {
 public:
  YamlMap();  // of no file, without keys
  // BOM and CRLF are fine. Errors: empty, a list, a key that stands twice, an alias, a second document, text that is
  // not UTF-8. name: for messages.
  static Result<YamlMap> Parse(std::string_view text, const std::string& name);
  bool Has(std::string_view key) const;   // does not take the key
  std::vector<std::string> Keys() const;  // in the order of the file
  bool IsMap(std::string_view key) const;
  bool IsNumber(std::string_view key) const;
  bool IsList(std::string_view key) const;
  std::string Text(std::string_view key, std::optional<std::string> otherwise = std::nullopt);  // no default: required
  double Number(std::string_view key, std::optional<double> otherwise = std::nullopt);          // finite
  std::vector<std::string> Texts(std::string_view key);
  std::array<double, 2> Interval(std::string_view key);  // [lower, upper], finite, lower < upper
  YamlMap Map(std::string_view key);                     // required mapping
  std::vector<YamlMap> Maps(std::string_view key);       // required list of mappings
  // Anything, passed through; null if absent. A plain scalar becomes a number only if the number is written the same
  // way: 12.5, but not the serial number 007 nor 1.10.
  nlohmann::json Json(std::string_view key);
  // The caller's own complaint about a key's value (of this mapping if the key is empty): "expected ...", which is
  // then preceded by what was found.
  void Fail(std::string_view key, const std::string& complaint);
  std::string Where(std::string_view key) const;  // dataset.yaml:12:5: search
  Result<void> Check() const;  // the first thing that was wrong so far; says nothing about unknown keys
  Result<void> Finish() const;

 private:
  YamlMap(std::shared_ptr<YamlFile> file, YamlNode* node);
  static YamlMap Open(const std::shared_ptr<YamlFile>& file, YamlNode map);

  std::shared_ptr<YamlFile> file_;
  YamlNode* node_;  // lives in file_
};

}  // namespace scancal
