// Pictures to be looked at.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace scancal {

// A PNG of 8 bits a colour. rgb: three bytes a pixel, row by row from the top. Empty where libpng has no memory.
std::string PngOf(uint32_t width, uint32_t height, const std::vector<uint8_t>& rgb);

}  // namespace scancal
