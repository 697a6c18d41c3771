// planes.yaml: which points of a scan are a placement each.
#pragma once
#include <filesystem>
#include <string>
#include <vector>
#include "models/turntable/declare.h"
#include "models/turntable/find_planes.h"

namespace scancal::turntable {

// The file's text, for all scans in which planes were found: of each its target, how many points it has, their
// checksum, and of each plane the points by their running numbers, a profile a line.
std::string PlanesToYaml(const std::vector<RangeImage>& images, const FoundPlanes& found);

// Puts, in place of each target with a file of planes, one for every plane of the file: "TARGET PLANE". Errors: `find`,
// which is no file yet; a file that is damaged, or that has nothing of the target.
Result<void> ChoosePlanes(Declaration* declaration);

// That the scan from which these points came is the one that its planes were found in.
Result<void> CheckSameScan(const ScanDeclaration& scan, const PointsChecksum& checksum);

// A page of its own: the range image of each scan with the planes coloured and numbered, and their table.
std::string PlanesPage(const std::vector<RangeImage>& images, const FoundPlanes& found);

}  // namespace scancal::turntable
