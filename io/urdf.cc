#include "io/urdf.h"
#include <tinyxml2.h>
#include <algorithm>
#include <map>
#include "io/dialect.h"
#include "io/message.h"
#include "io/number.h"

namespace scancal {
namespace {

struct Joint {
  UrdfJoint joint;
  std::string parent, type;
  bool mimics = false;
  int line = 0;
};

class UrdfReader {
 public:
  explicit UrdfReader(const std::string& name) : name_(name) {}

  Result<void> Read(std::string_view text) {
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      return Wrong(document.ErrorLineNum(), std::string("no XML (") + document.ErrorName() + "), expected a URDF");
    const tinyxml2::XMLElement* robot = document.FirstChildElement("robot");
    if (robot == nullptr) return Wrong(1, "found no element <robot>, expected a URDF");
    for (const auto* each = robot->FirstChildElement(); each != nullptr; each = each->NextSiblingElement())
      if (std::string_view(each->Name()).starts_with("xacro:"))
        return Wrong(each->GetLineNum(), "found macros (<" + std::string(each->Name()) +
                                             ">), expected a URDF: make one with the program xacro");
    for (const auto* each = robot->FirstChildElement("joint"); each != nullptr;
         each = each->NextSiblingElement("joint")) {
      SCANCAL_ASSIGN_OR_RETURN(Joint joint, JointOf(*each));
      const std::string child = joint.joint.child;
      if (!by_child_.emplace(child, std::move(joint)).second)
        return Wrong(each->GetLineNum(), "the link " + Quoted(child) + " hangs on two joints, expected one");
    }
    if (by_child_.empty()) return Wrong(robot->GetLineNum(), "found no joints, expected a robot");
    return {};
  }

  Result<std::vector<UrdfJoint>> Between(const std::string& base, const std::string& tip) const {
    if (tip.empty())
      return Error{name_ + ": found the links " + Listed(Links()) +
                   ", expected which of them is the flange: robot: {urdf: ..., tip: tool0}"};
    if (!by_child_.contains(tip))
      return Error{name_ + ": tip: found " + Quoted(tip) + ", which is no link that a joint carries" +
                   Suggestion(tip, Links())};
    std::vector<UrdfJoint> chain;
    std::string at = tip;
    for (auto joint = by_child_.find(at); joint != by_child_.end() && at != base; joint = by_child_.find(at)) {
      const Joint& found = joint->second;
      const std::string& joint_name = found.joint.name;
      if (found.type != "fixed" && !found.joint.turns)
        return Wrong(found.line, "joint " + Quoted(joint_name) + " is " + found.type +
                                     ", expected joints that turn (revolute, continuous) or are fixed up to the tip");
      if (found.mimics)
        return Wrong(found.line,
                     "joint " + Quoted(joint_name) + " follows another one (mimic), which is not known here");
      if (chain.size() > by_child_.size()) return Error{name_ + ": its links hang on each other in a circle"};
      chain.push_back(found.joint);
      at = found.parent;
    }
    if (!base.empty() && at != base)
      return Error{name_ + ": base: found " + Quoted(base) + ", which is no link between " + Quoted(at) + " and " +
                   Quoted(tip)};
    std::reverse(chain.begin(), chain.end());
    return chain;
  }

 private:
  Error Wrong(int line, const std::string& sentence) const {
    return {name_ + ":" + std::to_string(std::max(line, 1)) + ": " + sentence};
  }

  Result<std::array<double, 3>> Three(const tinyxml2::XMLElement* element, const char* attribute,
                                      const std::array<double, 3>& otherwise) const {
    const char* const text = element == nullptr ? nullptr : element->Attribute(attribute);
    if (text == nullptr) return otherwise;
    std::vector<double> numbers;
    std::string_view rest = text;
    for (;;) {
      const size_t begin = rest.find_first_not_of(" \t\r\n");
      if (begin == std::string_view::npos) break;
      const std::string_view word = rest.substr(begin, rest.find_first_of(" \t\r\n", begin) - begin);
      const ParsedNumber number = ParseNumber(word);
      if (number.kind == NumberKind::kNumber) numbers.push_back(number.value);
      rest.remove_prefix(begin + word.size());
      if (number.kind != NumberKind::kNumber || numbers.size() > 3) numbers.clear(), rest = {};
    }
    if (numbers.size() != 3)
      return Wrong(element->GetLineNum(),
                   std::string(attribute) + ": found " + Quoted(text) + ", expected three numbers");
    return std::array<double, 3>{numbers[0], numbers[1], numbers[2]};
  }

  Result<Joint> JointOf(const tinyxml2::XMLElement& element) const {
    const auto text = [](const tinyxml2::XMLElement* of, const char* attribute) {
      const char* const found = of == nullptr ? nullptr : of->Attribute(attribute);
      return std::string(found == nullptr ? "" : found);
    };
    Joint joint;
    joint.line = element.GetLineNum();
    joint.joint.name = text(&element, "name");
    joint.type = text(&element, "type");
    joint.parent = text(element.FirstChildElement("parent"), "link");
    joint.joint.child = text(element.FirstChildElement("child"), "link");
    joint.mimics = element.FirstChildElement("mimic") != nullptr;
    joint.joint.turns = joint.type == "revolute" || joint.type == "continuous";
    if (joint.parent.empty() || joint.joint.child.empty() || joint.type.empty())
      return Wrong(joint.line, "joint " + Quoted(joint.joint.name) + ": expected a type, a parent and a child");
    const auto* const origin = element.FirstChildElement("origin");
    SCANCAL_ASSIGN_OR_RETURN(joint.joint.xyz, Three(origin, "xyz", joint.joint.xyz));
    SCANCAL_ASSIGN_OR_RETURN(joint.joint.rpy, Three(origin, "rpy", joint.joint.rpy));
    const auto* const axis = element.FirstChildElement("axis");
    SCANCAL_ASSIGN_OR_RETURN(joint.joint.axis, Three(axis, "xyz", joint.joint.axis));
    const auto is_zero = [](double x) { return x == 0; };
    if (std::all_of(joint.joint.axis.begin(), joint.joint.axis.end(), is_zero))
      return Wrong(axis->GetLineNum(), "axis: found \"0 0 0\", expected a direction");
    return joint;
  }

  std::vector<std::string> Links() const {
    std::vector<std::string> links;
    for (const auto& [link, joint] : by_child_) links.push_back(link);
    return links;
  }

  const std::string& name_;
  std::map<std::string, Joint> by_child_;
};

}  // namespace

Result<std::vector<UrdfJoint>> ReadUrdf(std::string_view text, const std::string& name, const std::string& base,
                                        const std::string& tip) {
  UrdfReader reader(name);
  SCANCAL_RETURN_IF_ERROR(reader.Read(text));
  return reader.Between(base, tip);
}

}  // namespace scancal
