#include "io/yaml.h"
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>
#include "io/message.h"
#include "io/number.h"

namespace scancal {

struct YamlNode {
  YAML::Node value;
  YAML::Mark mark;
  std::string trail;                   // names the node in messages: "targets: item 2: keep"
  std::set<std::string> asked, taken;  // keys of a mapping that is read: somebody knows them, has read their value
};

struct YamlFile {
  std::string name;
  std::map<int, YamlNode> opened;  // the mappings that somebody reads key by key, by their position
  YamlNode nothing;                // stands in for a mapping that is absent or wrong
  std::optional<Error> error;
};

namespace {

std::string Joined(const std::string& first, const std::string& second) {
  return first.empty() || second.empty() ? first + second : first + ": " + second;
}

std::string PlaceIn(const std::string& name, size_t line, size_t column) {
  return name.empty() ? "" : name + ":" + std::to_string(line) + ":" + std::to_string(column);
}

std::string PlaceIn(const std::string& name, const YAML::Mark& mark) {
  const auto one_based = [](int position) { return static_cast<size_t>(std::max(position, 0)) + 1; };
  return PlaceIn(name, one_based(mark.line), one_based(mark.column));
}

std::string Where(const YamlFile& file, const YamlNode& node) {
  return Joined(PlaceIn(file.name, node.mark), node.trail);
}

// What was found, for messages.
std::string Found(const YAML::Node& value) {
  return value.IsMap()        ? "a mapping"
         : value.IsSequence() ? "a list"
         : value.IsNull()     ? "nothing"
                              : Quoted(value.Scalar());
}

// yaml-cpp gives a null the place of what follows.
YamlNode ValueOf(const YamlNode& map, const YAML::Node& key, const YAML::Node& value) {
  return {value, value.IsNull() ? key.Mark() : value.Mark(), Joined(map.trail, key.Scalar()), {}, {}};
}

std::vector<YamlNode> ItemsOf(const YamlNode& list) {
  std::vector<YamlNode> items;
  for (const YAML::Node& item : list.value)
    items.push_back({item, item.Mark(), Joined(list.trail, "item " + std::to_string(items.size() + 1)), {}, {}});
  return items;
}

std::optional<YamlNode> Find(const YamlNode& map, std::string_view key) {
  for (const auto& entry : map.value)
    if (entry.first.Scalar() == key) return ValueOf(map, entry.first, entry.second);
  return std::nullopt;
}

// Thrown, the only way to stop yaml-cpp's parser, and caught in Load.
struct NotForUs : YAML::Exception {
  using Exception::Exception;
};

// Refuses what is YAML but not for us, in the order of the file and with its place. yaml-cpp's tree tells less: there
// an alias is the node that it repeats, so that a short text may be a tree without end, and what stands behind the
// first document is not read.
class PlainDocument : public YAML::EventHandler {
  using Mark = YAML::Mark;
  using Tag = std::string;
  using Anchor = YAML::anchor_t;
  using Style = YAML::EmitterStyle::value;

  void OnDocumentStart(const Mark& mark) override {
    if (++documents_ > 1) throw NotForUs(mark, "found a second document, expected one");
  }
  void OnAlias(const Mark& mark, Anchor /*anchor*/) override {
    throw NotForUs(mark, "found an alias, expected the value itself");
  }
  void OnDocumentEnd() override {}
  void OnNull(const Mark& mark, Anchor /*anchor*/) override { Take(mark, nullptr, "nothing"); }
  void OnScalar(const Mark& mark, const Tag& /*tag*/, Anchor /*anchor*/, const std::string& text) override {
    Take(mark, &text, "");
  }
  void OnSequenceStart(const Mark& mark, const Tag& /*tag*/, Anchor /*anchor*/, Style /*style*/) override {
    Take(mark, nullptr, "a list");
    open_.emplace_back();
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const Mark& mark, const Tag& /*tag*/, Anchor /*anchor*/, Style /*style*/) override {
    Take(mark, nullptr, "a mapping");
    open_.push_back({.is_map = true, .expects_key = true, .lines = {}});
  }
  void OnMapEnd() override { open_.pop_back(); }

  // The next node: as a key of a mapping it is a scalar and stands once.
  void Take(const Mark& mark, const std::string* scalar, const std::string& found) {
    if (open_.empty() || !open_.back().is_map) return;
    Open& map = open_.back();
    map.expects_key = !map.expects_key;
    if (map.expects_key) return;  // it is a value
    if (scalar == nullptr) throw NotForUs(mark, "found " + found + ", expected a key");
    const auto [first, is_new] = map.lines.emplace(*scalar, mark.line + 1);
    if (!is_new)
      throw NotForUs(
          mark, "the key '" + *scalar + "' stands here a second time, first in line " + std::to_string(first->second));
  }

  struct Open {  // a mapping or a list
    bool is_map = false, expects_key = false;
    std::map<std::string, int> lines;  // of the keys
  };
  std::vector<Open> open_;
  int documents_ = 0;
};

Result<YAML::Node> Load(std::string_view text, const std::string& name) {
  text = WithoutByteOrderMark(text);
  if (const auto offset = FirstInvalidUtf8(text)) {
    const TextPlace place = PlaceOf(text, *offset);
    return Error{PlaceIn(name, place.line, place.column) +
                 ": found a byte that is not UTF-8; save the file as UTF-8 text"};
  }
  try {
    std::istringstream stream{std::string(text)};
    YAML::Parser parser(stream);
    PlainDocument document;
    while (parser.HandleNextDocument(document)) {
    }
    return YAML::Load(std::string(text));
  } catch (const NotForUs& complaint) {
    return Error{PlaceIn(name, complaint.mark) + ": " + complaint.msg};
  } catch (const YAML::Exception& exception) {
    return Error{PlaceIn(name, exception.mark) + ": not YAML: " + exception.msg};
  }
}

// Complaints about the stand-in would only follow from an earlier one.
void Remember(YamlFile& file, const YamlNode& node, const std::string& complaint) {
  if (!file.error && &node != &file.nothing) file.error = Error{Joined(Where(file, node), complaint)};
}

void RememberFound(YamlFile& file, const YamlNode& node, const std::string& expected) {
  Remember(file, node, "found " + Found(node.value) + ", expected " + expected);
}

std::vector<std::string> KeysOf(const YamlNode& map) {
  std::vector<std::string> keys;
  for (const auto& entry : map.value) keys.push_back(entry.first.Scalar());
  return keys;
}

std::optional<YamlNode> Take(YamlNode& map, std::string_view key) {
  map.asked.emplace(key);
  map.taken.emplace(key);
  return Find(map, key);
}

std::optional<YamlNode> Need(YamlFile& file, YamlNode& map, std::string_view key, const std::string& expected) {
  auto value = Take(map, key);
  if (value) return value;
  std::vector<std::string> untaken = KeysOf(map);
  std::erase_if(untaken, [&](const std::string& candidate) { return map.taken.contains(candidate); });
  const std::string nearest = Nearest(key, untaken);
  Remember(file, map,
           "the key '" + std::string(key) + "' is missing, expected " + expected +
               (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  return value;
}

std::string ToText(YamlFile& file, const YamlNode& node) {
  if (node.value.IsScalar()) return node.value.Scalar();
  RememberFound(file, node, "text");
  return "";
}

double ToNumber(YamlFile& file, const YamlNode& node) {
  const ParsedNumber number =
      node.value.IsScalar() ? ParseNumber(node.value.Scalar()) : ParsedNumber{NumberKind::kText, 0};
  if (number.kind == NumberKind::kNumber) return number.value;
  RememberFound(file, node, number.kind == NumberKind::kText ? "a number" : "a finite number");
  return 0;
}

nlohmann::json ToJson(const YAML::Node& node) {
  if (node.IsNull()) return nullptr;
  if (node.IsScalar()) {
    const std::string& text = node.Scalar();
    if (node.Tag() == "!") return text;  // it stands in quotes
    const auto value = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
    const bool kept = (value.is_number() || value.is_boolean()) && value.dump() == text;
    return kept ? value : nlohmann::json(text);
  }
  nlohmann::json json = node.IsMap() ? nlohmann::json::object() : nlohmann::json::array();
  for (const auto& item : node) {
    if (node.IsMap()) json[item.first.Scalar()] = ToJson(item.second);
    else json.push_back(ToJson(item));
  }
  return json;
}

}  // namespace

YamlMap::YamlMap() : file_(std::make_shared<YamlFile>()), node_(&file_->nothing) {}

YamlMap::YamlMap(std::shared_ptr<YamlFile> file, YamlNode* node) : file_(std::move(file)), node_(node) {}

Result<YamlMap> YamlMap::Parse(std::string_view text, const std::string& name) {
  SCANCAL_ASSIGN_OR_RETURN(const YAML::Node root, Load(text, name));
  if (root.IsNull()) return Error{name + ": the file is empty, expected \"key: value\" lines"};
  if (!root.IsMap())
    return Error{PlaceIn(name, root.Mark()) + ": found " + (root.IsSequence() ? "a list" : "other text") +
                 ", expected \"key: value\" lines"};
  auto file = std::make_shared<YamlFile>();
  file->name = name;
  return Open(file, {root, root.Mark(), "", {}, {}});
}

YamlMap YamlMap::Open(const std::shared_ptr<YamlFile>& file, YamlNode map) {
  const int position = map.mark.pos;
  return {file, &file->opened.emplace(position, std::move(map)).first->second};
}

bool YamlMap::Has(std::string_view key) const {
  node_->asked.emplace(key);
  return Find(*node_, key).has_value();
}

std::vector<std::string> YamlMap::Keys() const { return KeysOf(*node_); }

bool YamlMap::IsMap(std::string_view key) const {
  const auto value = Find(*node_, key);
  return value && value->value.IsMap();
}

bool YamlMap::IsList(std::string_view key) const {
  const auto value = Find(*node_, key);
  return value && value->value.IsSequence();
}

bool YamlMap::IsNumber(std::string_view key) const {
  const auto value = Find(*node_, key);
  return value && value->value.IsScalar() && ParseNumber(value->value.Scalar()).kind == NumberKind::kNumber;
}

std::string YamlMap::Text(std::string_view key, std::optional<std::string> otherwise) {
  const auto value = otherwise ? Take(*node_, key) : Need(*file_, *node_, key, "text");
  return value ? ToText(*file_, *value) : std::move(otherwise).value_or("");
}

double YamlMap::Number(std::string_view key, std::optional<double> otherwise) {
  const auto value = otherwise ? Take(*node_, key) : Need(*file_, *node_, key, "a number");
  return value ? ToNumber(*file_, *value) : otherwise.value_or(0);
}

std::vector<std::string> YamlMap::Texts(std::string_view key) {
  std::vector<std::string> texts;
  const auto value = Need(*file_, *node_, key, "a list of texts");
  if (!value) return texts;
  if (!value->value.IsSequence()) RememberFound(*file_, *value, "a list of texts");
  else
    for (const YamlNode& item : ItemsOf(*value)) texts.push_back(ToText(*file_, item));
  return texts;
}

std::array<double, 2> YamlMap::Interval(std::string_view key) {
  const std::string expected = "an interval [lower, upper]";
  constexpr std::array<double, 2> kHarmless = {0, 1};
  const auto value = Need(*file_, *node_, key, expected);
  if (!value) return kHarmless;
  if (!value->value.IsSequence()) {
    RememberFound(*file_, *value, expected);
    return kHarmless;
  }
  const std::vector<YamlNode> items = ItemsOf(*value);
  if (items.size() != 2) {
    Remember(*file_, *value, "found a list of " + std::to_string(items.size()) + ", expected " + expected);
    return kHarmless;
  }
  const std::array<double, 2> interval = {ToNumber(*file_, items[0]), ToNumber(*file_, items[1])};
  if (interval[0] < interval[1]) return interval;
  Remember(*file_, *value,
           "found [" + items[0].value.Scalar() + ", " + items[1].value.Scalar() +
               "], expected the lower bound first and a larger upper bound");
  return kHarmless;
}

YamlMap YamlMap::Map(std::string_view key) {
  auto value = Need(*file_, *node_, key, "a mapping");
  if (value && value->value.IsMap()) return Open(file_, *std::move(value));
  if (value) RememberFound(*file_, *value, "a mapping");
  return {file_, &file_->nothing};
}

std::vector<YamlMap> YamlMap::Maps(std::string_view key) {
  std::vector<YamlMap> maps;
  const auto value = Need(*file_, *node_, key, "a list of mappings");
  if (!value) return maps;
  if (!value->value.IsSequence()) {
    RememberFound(*file_, *value, "a list of mappings");
    return maps;
  }
  constexpr size_t kMost = 1000;  // targets, links: more are no declaration
  if (value->value.size() > kMost) {
    Remember(*file_, *value, "found " + std::to_string(value->value.size()) + " items, expected at most 1000");
    return maps;
  }
  for (const YamlNode& item : ItemsOf(*value)) {
    if (!item.value.IsMap()) RememberFound(*file_, item, "a mapping");
    maps.push_back(item.value.IsMap() ? Open(file_, item) : YamlMap(file_, &file_->nothing));
  }
  return maps;
}

nlohmann::json YamlMap::Json(std::string_view key) {
  const auto value = Take(*node_, key);
  return value ? ToJson(value->value) : nlohmann::json();
}

void YamlMap::Fail(std::string_view key, const std::string& complaint) {
  const auto value = key.empty() ? std::nullopt : Find(*node_, key);
  const bool shows_found = value && complaint.starts_with("expected");
  if (!file_->error)
    file_->error = Error{Where(key) + ": " + (shows_found ? "found " + Found(value->value) + ", " : "") + complaint};
}

std::string YamlMap::Where(std::string_view key) const {
  const auto value = key.empty() ? std::nullopt : Find(*node_, key);
  // An absent one: where it belongs.
  return value ? scancal::Where(*file_, *value) : Joined(scancal::Where(*file_, *node_), std::string(key));
}

Result<void> YamlMap::Check() const {
  if (file_->error) return *file_->error;
  return {};
}

Result<void> YamlMap::Finish() const {
  SCANCAL_RETURN_IF_ERROR(Check());
  const YamlNode* map = nullptr;
  std::optional<YAML::Node> unknown;  // the first one in the order of the file
  for (const auto& [position, opened] : file_->opened)
    for (const auto& entry : opened.value) {
      const YAML::Node& key = entry.first;
      if (opened.taken.contains(key.Scalar()) || (unknown && unknown->Mark().pos < key.Mark().pos)) continue;
      map = &opened;
      unknown.emplace(key);
    }
  if (!unknown) return {};
  return Error{Joined(PlaceIn(file_->name, unknown->Mark()), map->trail) + ": unknown key '" + unknown->Scalar() + "'" +
               Suggestion(unknown->Scalar(), {map->asked.begin(), map->asked.end()})};
}

}  // namespace scancal
