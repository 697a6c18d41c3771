// Compressed placements as JSON and back: what a result is recomputed from, years later and without the points.
#pragma once
#include <string>
#include <vector>
#include "io/json_file.h"
#include "io/result.h"
#include "models/turntable/placement.h"

namespace scancal {

// {"layout": what follows in plain words, "targets": [...], "sha256": of the text of segments, "segments": base64 of
// little-endian float64}. Every digit is kept: the same placements come back, to the last bit.
Result<Json> PlacementsToJson(const std::vector<Placement>& placements);

// Refuses what is damaged, incomplete or no data of a turntable, in one sentence that names the file.
Result<std::vector<Placement>> PlacementsFromJson(const Json& data, const std::string& file);

}  // namespace scancal
