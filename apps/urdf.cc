// scancal urdf CALIBRATION --out=FILE
#include "models/chain/urdf.h"
#include <fmt/format.h>
#include <gflags/gflags.h>
#include <cstdio>
#include "apps/command.h"
#include "apps/recheck.h"
#include "io/message.h"
#include "io/output_file.h"
#include "models/chain/declare.h"
#include "models/chain/tables.h"

DECLARE_string(out);

namespace scancal {
namespace {

// Links as calibrated, with the names and the base of the URDF that the nominal ones came from.
Result<UrdfLinks> CalibratedArm(const Calibration& calibration, const Arm& declared) {
  const std::vector<Link> nominal = NominalLinksOf(calibration);
  if (nominal.empty())
    return Error{
        "the calibration knows no links of a robot: it is of a turntable, or its poses were those of the flange"};
  SCANCAL_ASSIGN_OR_RETURN(const std::vector<Link> errors, LinkErrorsOf(calibration, nominal.size()));
  return UrdfLinks{WithErrors(nominal, errors), declared.base_from_first, declared.joints};
}

// What the flange carries: the scanner, the points or the target that a tracker saw, the ball of a flange-ball.
std::map<std::string, Eigen::Isometry3d> OnFlange(const Calibration& calibration) {
  std::map<std::string, Eigen::Isometry3d> carried;
  if (const auto hand_eye = calibration.frames.find("hand_eye"); hand_eye != calibration.frames.end())
    carried[calibration.model == "robot-ball" ? "scanner" : "tool"] = Eigen::Isometry3d(hand_eye->second);
  if (const auto ball = ValuesOf(calibration, {"ball_x", "ball_y", "ball_z"});
      calibration.Find("ball_x") && ball.ok()) {
    carried["ball"] = Eigen::Isometry3d::Identity();
    carried["ball"].translation() = ball->head<3>();
  }
  return carried;
}

std::vector<std::string> LeftOut(const Calibration& calibration, const Arm& declared, size_t links) {
  std::vector<std::string> notes, terms;
  Quantities quantities;
  DeclareJointTerms(links, &quantities);
  for (const Quantity& quantity : quantities)
    if (const Parameter* parameter = calibration.Find(quantity.name); parameter && parameter->value != 0)
      terms.push_back(quantity.name);
  if (const Parameter* expansion = calibration.Find("expansion"); expansion && expansion->value != 0)
    terms.push_back(expansion->name);
  if (!terms.empty()) notes.push_back("joints of a URDF turn by what they read; left out: " + Listed(terms));
  for (const Coupling& each : declared.couplings)
    notes.push_back(fmt::format("joint {0} turns by q{0} {1} q{2} of the controller", each.joint + 1,
                                each.times > 0 ? '+' : '-', each.with + 1));
  return notes;
}

Result<int> Written(const std::string& file) {
  SCANCAL_ASSIGN_OR_RETURN(const Rechecked checked, RecheckForUse(file));
  const Calibration& calibration = checked.again ? *checked.again : checked.found;
  Arm declared;
  if (checked.scanner) {
    SCANCAL_ASSIGN_OR_RETURN(declared, ReadArm(checked.scanner->dataset()));
  }
  SCANCAL_ASSIGN_OR_RETURN(const UrdfLinks arm, CalibratedArm(calibration, declared));
  const std::vector<std::string> notes = LeftOut(calibration, declared, arm.links.size());
  const std::string name = calibration.name.empty() ? "robot" : calibration.name;
  SCANCAL_RETURN_IF_ERROR(WriteFile(FLAGS_out, UrdfOf(name, arm, OnFlange(calibration), notes)));
  std::printf("wrote %zu joints, base_link to flange, to %s\n", arm.links.size(), FLAGS_out.c_str());
  for (const std::string& note : notes) std::fprintf(stderr, "scancal: warning: %s\n", note.c_str());
  return WarnOf(checked, file);
}

int RunUrdf(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1)
    return Complain("found " + std::to_string(arguments.size()) + " arguments, expected one: a calibration.json");
  if (FLAGS_out.empty()) return Complain("--out: expected the URDF to write");
  const Result<int> code = Written(arguments[0]);
  return code.ok() ? *code : Complain(code.error().message);
}

}  // namespace

const Command kUrdfCommand = {"urdf",
                              "CALIBRATION",
                              "the calibrated robot as a URDF, with what its flange carries",
                              {{"out", "URDF to write"}, {"unreliable"}, {"key"}},
                              &RunUrdf};

}  // namespace scancal
