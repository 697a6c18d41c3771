// The type of JSON documents, for declarations: what makes or reads one includes io/json_file.h, whose header takes a
// compiler three seconds.
#pragma once
#include <nlohmann/json_fwd.hpp>

namespace scancal {

// Keys keep the order in which they were put in.
using Json = nlohmann::ordered_json;

}  // namespace scancal
