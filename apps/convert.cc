// scancal convert IN OUT
#include <fmt/format.h>
#include <gflags/gflags.h>
#include <filesystem>
#include "apps/command.h"
#include "io/dataset.h"
#include "io/message.h"
#include "io/scan_writer.h"
#include "models/turntable/declare.h"

DEFINE_string(
    as, "",
    "what a data set would say of the file: \"{layout: {image: y, scale: 0.001, start: -16, step: 0.01}, angle: "
    "{start: 0, step: 0.1}}\"");

namespace scancal {
namespace {

Result<int> Converted(const std::string& argument, const std::string& out) {
  const std::string in = argument == "-" ? "/dev/stdin" : argument;
  YamlMap declared;
  if (!FLAGS_as.empty()) {
    SCANCAL_ASSIGN_OR_RETURN(declared, YamlMap::Parse(FLAGS_as, "--as"));
  }
  const Units units = declared.Has("units") ? ReadUnits(declared.Map("units")) : Units();
  ScanFormat format = turntable::ScanFormatOf(in, units);
  turntable::ReadScanFormat(declared, "", &format);
  const std::string depth = declared.Has("depth") ? declared.Text("depth") : "";
  if (!depth.empty() && depth != "away" && depth != "towards")
    declared.Fail("depth", "expected away or towards: which way the sensor's depth grows");
  SCANCAL_RETURN_IF_ERROR(declared.Finish());
  std::error_code ignored;
  if (std::filesystem::equivalent(in, out, ignored)) return Error{out + ": that is the file to read, expected another"};
  SCANCAL_ASSIGN_OR_RETURN(const std::unique_ptr<ScanReader> reader, ScanReader::Open(format));
  SCANCAL_ASSIGN_OR_RETURN(const std::unique_ptr<ScanWriter> writer, ScanWriter::Create(out, format.columns));
  for (ScanBatch batch;;) {
    SCANCAL_ASSIGN_OR_RETURN(const bool more, reader->Next(&batch));
    if (!more) break;
    SCANCAL_RETURN_IF_ERROR(writer->Write(batch));
  }
  if (writer->points() == 0) return Error{in + ": no points: all are missing"};
  SCANCAL_RETURN_IF_ERROR(writer->Commit());
  if (const std::string found = reader->Describe(); !found.empty()) fmt::print("{}: {}\n", in, found);
  fmt::print("wrote {} points to {}, {} missing left out; columns: [{}]\n", writer->points(), out, reader->missing(),
             Listed(writer->names()));
  if (depth == "towards" || (depth.empty() && reader->gives_heights()))
    fmt::print("depth is as it was: a data set of {} declares depth: towards\n", out);
  return kTrusted;
}

int RunConvert(const std::vector<std::string>& arguments) {
  if (arguments.size() != 2)
    return Complain(
        fmt::format("found {} arguments, expected two: a file to read, and one to write", arguments.size()));
  const Result<int> code = Converted(arguments[0], arguments[1]);
  return code.ok() ? *code : Complain(code.error().message);
}

}  // namespace

const Command kConvertCommand = {"convert",
                                 "IN OUT",
                                 "a scan in any format that a data set may name, as .csv, .npy, .ply or .pcd",
                                 {{"as"}},
                                 &RunConvert};

}  // namespace scancal
