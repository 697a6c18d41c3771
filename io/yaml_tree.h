// The tree of a YAML file, every node with its place.
#pragma once
#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>
#include "io/result.h"

namespace scancal {

struct YamlKey {
  std::string text;
  size_t line = 1, column = 1;
  bool taken = false;  // somebody read its value
};

struct YamlNode {
  enum class Kind { kNothing, kScalar, kList, kMap };
  Kind kind = Kind::kNothing;
  std::string text;     // of a scalar
  bool quoted = false;  // "1" as opposed to 1
  size_t line = 1, column = 1;
  std::string trail;               // names the node in messages: "targets: item 2: keep"
  std::vector<YamlNode> children;  // items of a list, values of a mapping
  std::vector<YamlKey> keys;       // of a mapping, as many as children
  bool opened = false;             // somebody reads this mapping key by key ...
  std::set<std::string> asked;     // ... and knows these

  YamlNode* Find(std::string_view key);  // nullptr if absent
  const YamlNode* Find(std::string_view key) const;
  std::string Found() const;  // for messages: "a list", "nothing", "\"12.3.4\""
};

// Duplicate keys, anchors, aliases, a second document and text that is not UTF-8 are errors. `name` is the file's.
Result<YamlNode> ParseYaml(std::string_view text, const std::string& name);

}  // namespace scancal
