// scancal planes DATASET --out=FOLDER
#include <fmt/format.h>
#include <gflags/gflags.h>
#include <filesystem>
#include "apps/calibrate.h"
#include "apps/command.h"
#include "io/output_file.h"
#include "io/progress.h"
#include "models/turntable/planes_file.h"

DECLARE_string(out);

namespace scancal {
namespace {

Result<int> Found(const std::vector<std::string>& arguments) {
  SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset, ReadOnlyArgument(arguments));
  if (dataset.model != "turntable")
    return Error{dataset.yaml.Where("model") + ": found \"" + dataset.model +
                 "\", expected turntable: no other scans planes"};
  turntable::Model model(turntable::Model::Residuals::kDepth);
  SCANCAL_ASSIGN_OR_RETURN(const turntable::Declaration declaration, turntable::Declare(dataset, &model));
  const std::filesystem::path folder = FLAGS_out, yaml = folder / "planes.yaml", page = folder / "planes.html";
  if (std::filesystem::exists(yaml))
    return Error{yaml.string() +
                 ": is there already, and may hold your choice; remove it, or name another folder by --out"};
  std::vector<turntable::RangeImage> images;
  int64_t left = turntable::RangeImage::kMostPoints;
  for (const turntable::ScanDeclaration& scan : declaration.scans) {
    if (scan.planes.empty()) continue;
    Progress progress("reading " + scan.scan);
    SCANCAL_ASSIGN_OR_RETURN(
        images.emplace_back(),
        turntable::ReadRangeImage(scan, declaration.senses, left, [&](double done) { progress.Show(done); }));
    left -= std::ssize(images.back().y);
  }
  if (images.empty())
    return Error{dataset.file.string() + ": no target says planes: find, so each is one plane as it is"};
  turntable::FoundPlanes found;
  {
    Progress progress("finding planes");
    found = turntable::FindPlanes(images, declaration, model, [&](double done) { progress.Show(done); });
  }
  size_t planes = 0;
  for (size_t s = 0; s < images.size(); ++s) {
    const turntable::PlanesOfScan& of_scan = found.scans[s];
    planes += of_scan.planes.size();
    fmt::print(
        "{}: {} planes in {} points of {} profiles; refused: {} regions that are bent or creased, {} within 15 "
        "degrees of edge-on\n",
        images[s].name, of_scan.planes.size(), images[s].y.size(), images[s].rows, of_scan.bent, of_scan.edge_on);
    for (const turntable::FoundPlane& plane : of_scan.planes)
      fmt::print("  {:<18} {:>8} points, rms {:.3g} mm along depth\n", NameOf(images[s], plane), plane.points.size(),
                 plane.rms);
  }
  SCANCAL_RETURN_IF_ERROR(WriteFile(page, turntable::PlanesPage(images, found)));
  if (planes == 0)
    return Error{
        fmt::format("no plane was found; {} shows the scan: are search:, rotation and units right, is there a "
                    "plane of 200 points or more?",
                    page.string())};
  SCANCAL_RETURN_IF_ERROR(WriteFile(yaml, PlanesToYaml(images, found)));
  fmt::print(
      "{}wrote {} and {}: look at the page, take out of the file what is no plane, and name it in the data set: "
      "planes: {}\n",
      found.refined ? "" : "M and N did not follow from these planes, each was judged with its own\n", yaml.string(),
      page.string(), std::filesystem::proximate(yaml, dataset.file.parent_path()).string());
  return kTrusted;
}

int RunPlanes(const std::vector<std::string>& arguments) {
  const Result<int> code = Found(arguments);
  return code.ok() ? *code : Complain(code.error().message);
}

}  // namespace

const Command kPlanesCommand = {"planes",
                                "DATASET",
                                "proposes the planes of uncropped scans (planes: find), with a picture",
                                {{"out", "folder for planes.yaml and planes.html"}},
                                &RunPlanes};

}  // namespace scancal
