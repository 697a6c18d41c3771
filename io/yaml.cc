#include "io/yaml.h"
#include <nlohmann/json.hpp>
#include <utility>
#include "io/message.h"
#include "io/number.h"
#include "io/yaml_tree.h"

namespace scancal {

struct YamlFile {
  std::string name;
  YamlNode root;
  YamlNode nothing;  // stands in for a mapping that is absent or wrong
  std::optional<Error> error;
};

namespace {

using Kind = YamlNode::Kind;

std::string PlaceIn(const YamlFile& file, size_t line, size_t column) {
  return file.name.empty() ? "" : file.name + ":" + std::to_string(line) + ":" + std::to_string(column) + ": ";
}

std::string PlaceOf(const YamlFile& file, const YamlNode& node) {
  return PlaceIn(file, node.line, node.column) + (node.trail.empty() ? "" : node.trail + ": ");
}

std::vector<std::string> AskedKeys(const YamlNode& node) { return {node.asked.begin(), node.asked.end()}; }

// The first key in the order of the file that stands in an opened mapping and was not taken.
std::optional<Error> FindUnknownKey(const YamlFile& file, const YamlNode& node) {
  for (size_t i = 0; i < node.children.size(); ++i) {
    if (node.opened && !node.keys[i].taken) {
      const YamlKey& key = node.keys[i];
      const std::string trail = node.trail.empty() ? "" : node.trail + ": ";
      return Error{PlaceIn(file, key.line, key.column) + trail + "unknown key '" + key.text + "'" +
                   Suggestion(key.text, AskedKeys(node))};
    }
    if (auto error = FindUnknownKey(file, node.children[i])) return error;
  }
  return std::nullopt;
}

nlohmann::json ToJson(const YamlNode& node) {
  switch (node.kind) {
    case Kind::kNothing:
      return nullptr;
    case Kind::kScalar: {
      if (node.quoted) return node.text;
      const auto value = nlohmann::json::parse(node.text, nullptr, /*allow_exceptions=*/false);
      const bool kept = (value.is_number() || value.is_boolean()) && value.dump() == node.text;
      return kept ? value : nlohmann::json(node.text);
    }
    case Kind::kList: {
      auto list = nlohmann::json::array();
      for (const YamlNode& item : node.children) list.push_back(ToJson(item));
      return list;
    }
    case Kind::kMap: {
      auto map = nlohmann::json::object();
      for (size_t i = 0; i < node.keys.size(); ++i) map[node.keys[i].text] = ToJson(node.children[i]);
      return map;
    }
  }
  return nullptr;
}

}  // namespace

YamlMap::YamlMap() : file_(std::make_shared<YamlFile>()), node_(&file_->root) { node_->kind = Kind::kMap; }

YamlMap::YamlMap(std::shared_ptr<YamlFile> file, YamlNode* node) : file_(std::move(file)), node_(node) {
  node_->opened = true;
}

Result<YamlMap> YamlMap::Parse(std::string_view text, const std::string& name) {
  SCANCAL_ASSIGN_OR_RETURN(YamlNode root, ParseYaml(text, name));
  if (root.kind == Kind::kNothing) return Error{name + ": the file is empty, expected \"key: value\" lines"};
  auto file = std::make_shared<YamlFile>();
  file->name = name;
  file->root = std::move(root);
  file->nothing.kind = Kind::kMap;
  if (file->root.kind != Kind::kMap) {
    return Error{PlaceOf(*file, file->root) + "found " + file->root.Found() + ", expected \"key: value\" lines"};
  }
  YamlNode* const node = &file->root;
  return YamlMap(std::move(file), node);
}

bool YamlMap::Has(std::string_view key) const {
  node_->asked.emplace(key);
  return node_->Find(key) != nullptr;
}

std::vector<std::string> YamlMap::Keys() const {
  std::vector<std::string> keys;
  for (const YamlKey& key : node_->keys) keys.push_back(key.text);
  return keys;
}

bool YamlMap::IsMap(std::string_view key) const {
  const YamlNode* const value = node_->Find(key);
  return value != nullptr && value->kind == Kind::kMap;
}

bool YamlMap::IsNumber(std::string_view key) const {
  const YamlNode* const value = node_->Find(key);
  return value != nullptr && value->kind == Kind::kScalar && ParseNumber(value->text).kind == NumberKind::kNumber;
}

YamlNode* YamlMap::Take(std::string_view key) {
  node_->asked.emplace(key);
  for (YamlKey& candidate : node_->keys) {
    if (candidate.text == key) candidate.taken = true;
  }
  return node_->Find(key);
}

YamlNode* YamlMap::Need(std::string_view key, std::string_view expected) {
  YamlNode* const value = Take(key);
  if (value == nullptr) {
    std::vector<std::string> untaken;
    for (const YamlKey& candidate : node_->keys) {
      if (!candidate.taken) untaken.push_back(candidate.text);
    }
    const std::string nearest = Nearest(key, untaken);
    Remember(*node_, "the key '" + std::string(key) + "' is missing, expected " + std::string(expected) +
                         (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
  return value;
}

void YamlMap::Remember(const YamlNode& node, const std::string& complaint) {
  // Complaints about the stand-in would only follow from an earlier one.
  if (!file_->error && &node != &file_->nothing) file_->error = Error{PlaceOf(*file_, node) + complaint};
}

YamlMap YamlMap::Nothing() const { return {file_, &file_->nothing}; }

std::string YamlMap::ToText(const YamlNode& node) {
  if (node.kind == Kind::kScalar) return node.text;
  Remember(node, "found " + node.Found() + ", expected text");
  return "";
}

double YamlMap::ToNumber(const YamlNode& node) {
  const ParsedNumber number = node.kind == Kind::kScalar ? ParseNumber(node.text) : ParsedNumber{NumberKind::kText, 0};
  if (number.kind == NumberKind::kNumber) return number.value;
  Remember(node,
           "found " + node.Found() + ", expected a " + (number.kind == NumberKind::kText ? "" : "finite ") + "number");
  return 0;
}

std::string YamlMap::Text(std::string_view key, std::optional<std::string> otherwise) {
  const YamlNode* const value = otherwise ? Take(key) : Need(key, "text");
  return value != nullptr ? ToText(*value) : std::move(otherwise).value_or("");
}

double YamlMap::Number(std::string_view key, std::optional<double> otherwise) {
  const YamlNode* const value = otherwise ? Take(key) : Need(key, "a number");
  return value != nullptr ? ToNumber(*value) : otherwise.value_or(0);
}

std::vector<std::string> YamlMap::Texts(std::string_view key) {
  std::vector<std::string> texts;
  const YamlNode* const value = Need(key, "a list of texts");
  if (value == nullptr) return texts;
  if (value->kind != Kind::kList) Remember(*value, "found " + value->Found() + ", expected a list of texts");
  if (value->kind == Kind::kList) {
    for (const YamlNode& item : value->children) texts.push_back(ToText(item));
  }
  return texts;
}

std::array<double, 2> YamlMap::Interval(std::string_view key) {
  constexpr std::string_view kExpected = "an interval [lower, upper]";
  constexpr std::array<double, 2> kHarmless = {0, 1};
  const YamlNode* const value = Need(key, kExpected);
  if (value == nullptr) return kHarmless;
  if (value->kind != Kind::kList || value->children.size() != 2) {
    const bool is_list = value->kind == Kind::kList;
    Remember(*value, "found " + (is_list ? "a list of " + std::to_string(value->children.size()) : value->Found()) +
                         ", expected " + std::string(kExpected));
    return kHarmless;
  }
  const std::array<double, 2> interval = {ToNumber(value->children[0]), ToNumber(value->children[1])};
  if (interval[0] < interval[1]) return interval;
  Remember(*value, "found [" + value->children[0].text + ", " + value->children[1].text +
                       "], expected the lower bound first and a larger upper bound");
  return kHarmless;
}

YamlMap YamlMap::Map(std::string_view key) {
  YamlNode* const value = Need(key, "a mapping");
  if (value == nullptr) return Nothing();
  if (value->kind == Kind::kMap) return {file_, value};
  Remember(*value, "found " + value->Found() + ", expected a mapping");
  return Nothing();
}

std::vector<YamlMap> YamlMap::Maps(std::string_view key) {
  std::vector<YamlMap> maps;
  YamlNode* const value = Need(key, "a list of mappings");
  if (value == nullptr) return maps;
  if (value->kind != Kind::kList) {
    Remember(*value, "found " + value->Found() + ", expected a list of mappings");
    return maps;
  }
  for (YamlNode& item : value->children) {
    if (item.kind == Kind::kMap) {
      maps.push_back(YamlMap(file_, &item));
    } else {
      Remember(item, "found " + item.Found() + ", expected a mapping");
      maps.push_back(Nothing());
    }
  }
  return maps;
}

nlohmann::json YamlMap::Json(std::string_view key) {
  const YamlNode* const value = Take(key);
  return value != nullptr ? ToJson(*value) : nlohmann::json();
}

void YamlMap::Fail(std::string_view key, const std::string& complaint) {
  const YamlNode* const value = key.empty() ? nullptr : node_->Find(key);
  const bool shows_found = value != nullptr && complaint.starts_with("expected");
  if (!file_->error) {
    file_->error = Error{Where(key) + ": " + (shows_found ? "found " + value->Found() + ", " : "") + complaint};
  }
}

std::string YamlMap::Where(std::string_view key) const {
  const YamlNode* const value = key.empty() ? nullptr : node_->Find(key);
  std::string where = PlaceOf(*file_, value != nullptr ? *value : *node_);
  if (value == nullptr && !key.empty()) return where + std::string(key);  // absent: where it belongs
  where.resize(where.size() - std::min<size_t>(where.size(), 2));         // without the last ": "
  return where;
}

Result<void> YamlMap::Check() const {
  if (file_->error) return *file_->error;
  return {};
}

Result<void> YamlMap::Finish() const {
  SCANCAL_RETURN_IF_ERROR(Check());
  if (auto unknown = FindUnknownKey(*file_, file_->root)) return *unknown;
  return {};
}

}  // namespace scancal
