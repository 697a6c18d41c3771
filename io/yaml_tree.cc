#include "io/yaml_tree.h"
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>
#include <algorithm>
#include <sstream>
#include <utility>
#include "io/message.h"

namespace scancal {
namespace {

size_t OneBased(int position) { return static_cast<size_t>(std::max(position, 0)) + 1; }

// What is YAML but not for us. Thrown, the only way to stop yaml-cpp's parser, and caught in ParseYaml.
struct Complaint {
  Complaint(const YAML::Mark& mark, std::string sentence)
      : line(OneBased(mark.line)), column(OneBased(mark.column)), sentence(std::move(sentence)) {}
  size_t line, column;
  std::string sentence;
};

// yaml-cpp's own tree drops the second of two equal keys and the places of keys; its events have both.
class TreeBuilder : public YAML::EventHandler {
 public:
  YamlNode TakeRoot() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) throw Complaint(mark, "found a second document, expected one");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    Attach(At(mark, YamlNode::Kind::kNothing), mark);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    throw Complaint(mark, "found an alias, expected the value itself");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t /*anchor*/,
                const std::string& value) override {
    YamlNode node = At(mark, YamlNode::Kind::kScalar);
    node.text = value;
    node.quoted = tag == "!";
    Attach(std::move(node), mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {
    Open(At(mark, YamlNode::Kind::kList), mark);
  }
  void OnSequenceEnd() override { Close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    Open(At(mark, YamlNode::Kind::kMap), mark);
  }
  void OnMapEnd() override { Close(); }

 private:
  static YamlNode At(const YAML::Mark& mark, YamlNode::Kind kind) {
    YamlNode node;
    node.kind = kind;
    node.line = OneBased(mark.line);
    node.column = OneBased(mark.column);
    return node;
  }

  bool ExpectsKey() const {
    return !open_.empty() && open_.back().kind == YamlNode::Kind::kMap &&
           open_.back().keys.size() == open_.back().children.size();
  }

  void Open(YamlNode node, const YAML::Mark& mark) {
    if (ExpectsKey()) throw Complaint(mark, "found " + node.Found() + ", expected a key");
    open_.push_back(std::move(node));
  }

  void Close() {
    YamlNode node = std::move(open_.back());
    open_.pop_back();
    Attach(std::move(node), YAML::Mark());
  }

  void Attach(YamlNode node, const YAML::Mark& mark) {
    if (open_.empty()) {
      root_ = std::move(node);
    } else if (ExpectsKey()) {
      AttachKey(node, mark);
    } else {
      if (node.kind == YamlNode::Kind::kNothing && open_.back().kind == YamlNode::Kind::kMap) {
        node.line = open_.back().keys.back().line;  // yaml-cpp has the place of what follows
        node.column = open_.back().keys.back().column;
      }
      open_.back().children.push_back(std::move(node));
    }
  }

  void AttachKey(const YamlNode& node, const YAML::Mark& mark) {
    if (node.kind != YamlNode::Kind::kScalar) {
      throw Complaint(mark, "found " + node.Found() + ", expected a key");
    }
    for (const YamlKey& key : open_.back().keys) {
      if (key.text == node.text) {
        throw Complaint(
            mark, "the key '" + key.text + "' stands here a second time, first in line " + std::to_string(key.line));
      }
    }
    open_.back().keys.push_back({.text = node.text, .line = node.line, .column = node.column});
  }

  YamlNode root_;
  std::vector<YamlNode> open_;
  int documents_ = 0;
};

void NameTrails(YamlNode& node) {
  const std::string start = node.trail.empty() ? "" : node.trail + ": ";
  for (size_t i = 0; i < node.children.size(); ++i) {
    const bool in_map = node.kind == YamlNode::Kind::kMap;
    node.children[i].trail = start + (in_map ? node.keys[i].text : "item " + std::to_string(i + 1));
    NameTrails(node.children[i]);
  }
}

std::string Place(const std::string& name, size_t line, size_t column) {
  return name + ":" + std::to_string(line) + ":" + std::to_string(column) + ": ";
}

}  // namespace

YamlNode* YamlNode::Find(std::string_view key) {
  return const_cast<YamlNode*>(std::as_const(*this).Find(key));  // *this is not const
}

const YamlNode* YamlNode::Find(std::string_view key) const {
  for (size_t i = 0; i < keys.size(); ++i) {
    if (keys[i].text == key) return &children[i];
  }
  return nullptr;
}

std::string YamlNode::Found() const {
  switch (kind) {
    case Kind::kNothing:
      return "nothing";
    case Kind::kScalar:
      return Quoted(text);
    case Kind::kList:
      return "a list";
    case Kind::kMap:
      return "a mapping";
  }
  return "";
}

Result<YamlNode> ParseYaml(std::string_view text, const std::string& name) {
  text = WithoutByteOrderMark(text);
  if (const auto offset = FirstInvalidUtf8(text)) {
    const TextPlace place = PlaceOf(text, *offset);
    return Error{Place(name, place.line, place.column) + "found a byte that is not UTF-8; save the file as UTF-8 text"};
  }
  try {
    std::istringstream stream{std::string(text)};
    YAML::Parser parser(stream);
    TreeBuilder builder;
    while (parser.HandleNextDocument(builder)) {
    }
    YamlNode root = builder.TakeRoot();
    NameTrails(root);
    return root;
  } catch (const Complaint& complaint) {
    return Error{Place(name, complaint.line, complaint.column) + complaint.sentence};
  } catch (const YAML::Exception& exception) {
    return Error{Place(name, OneBased(exception.mark.line), OneBased(exception.mark.column)) +
                 "not YAML: " + exception.msg};
  }
}

}  // namespace scancal
