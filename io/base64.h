// Bytes as text (RFC 4648, section 4).
#pragma once
#include <string>
#include <string_view>
#include "io/result.h"

namespace scancal {

std::string ToBase64(std::string_view bytes);
// Padded, without blanks or line ends; up to 1 GiB. Says at which character the text is none.
Result<std::string> FromBase64(std::string_view text);

}  // namespace scancal
