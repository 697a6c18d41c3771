// scancal verify CALIBRATION VERIFY.yaml
#include <gflags/gflags.h>
#include <algorithm>
#include <cstdio>
#include "apps/command.h"
#include "apps/recheck.h"
#include "io/message.h"
#include "io/number.h"
#include "io/output_file.h"
#include "models/models.h"
#include "report/text.h"

DECLARE_string(out);
DEFINE_string(at, "", "other values of parameters, mm and rad: \"M:120,N:405\"; u stays that of the calibration");

namespace scancal {
namespace {

// Puts the values of --at in place of those that were found.
Result<void> MoveTo(const std::string& text, Calibration* calibration) {
  for (size_t from = 0; from < text.size();) {
    const size_t end = std::min(text.find(',', from), text.size());
    const std::string each = text.substr(from, end - from);
    const size_t colon = std::min(each.find(':'), each.size());
    const ParsedNumber value = ParseNumber(std::string_view(each).substr(std::min(colon + 1, each.size())));
    std::vector<std::string> known;
    bool found = false;
    for (Parameter& parameter : calibration->parameters) {
      known.push_back(parameter.name);
      if (parameter.name != each.substr(0, colon) || value.kind != NumberKind::kNumber) continue;
      parameter.value = value.value;
      found = true;
    }
    if (!found)
      return Error{"--at: found " + Quoted(each) + ", expected parameters and values, as M:120,N:405" +
                   Suggestion(each.substr(0, colon), known)};
    from = end + 1;
  }
  return {};
}

Result<int> Verified(const std::string& file, const std::string& features) {
  SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset, ReadDataset(features));
  SCANCAL_ASSIGN_OR_RETURN(const ScannerKind* kind, FindScannerKind(dataset));
  SCANCAL_ASSIGN_OR_RETURN(const Rechecked checked, RecheckForUse(CalibrationIn(file)));
  SCANCAL_RETURN_IF_ERROR(CheckSameInstrument(checked, dataset));
  if (!kind->verify)
    return Error{std::string("verify: the model ") + kind->name +
                 " measures no features, expected a calibration of one that does; `check:` has known lengths"};
  Calibration calibration = checked.found;
  SCANCAL_RETURN_IF_ERROR(MoveTo(FLAGS_at, &calibration));
  SCANCAL_ASSIGN_OR_RETURN(Verification verification, kind->verify(dataset, calibration));
  if (!FLAGS_at.empty()) {
    verification.scale.reset();
    verification.notes.push_back("with " + FLAGS_at + ", not as calibrated; u is that of the calibration");
  }
  if (!FLAGS_out.empty()) SCANCAL_RETURN_IF_ERROR(WriteFile(FLAGS_out, ToCsv(verification)));
  std::printf("%s", ToText(verification).c_str());
  const int code = WarnOf(checked, file);
  return verification.out() ? kFoundOut : code;
}

int RunVerify(const std::vector<std::string>& arguments) {
  if (arguments.size() != 2)
    return Complain("found " + std::to_string(arguments.size()) +
                    " arguments, expected two: a calibration.json and the data set of an artifact");
  const Result<int> code = Verified(arguments[0], arguments[1]);
  return code.ok() ? *code : Complain(code.error().message);
}

}  // namespace

const Command kVerifyCommand = {"verify",
                                "FILE.json VERIFY.yaml",
                                "an artifact that took no part, measured with the calibration: deviations, U, E_n",
                                {{"at"}, {"out", "CSV file to write"}, {"unreliable"}, {"key"}},
                                &RunVerify};

}  // namespace scancal
