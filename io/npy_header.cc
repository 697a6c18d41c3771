#include "io/npy_header.h"
#include <charconv>
#include <string_view>
#include <vector>
#include "io/message.h"
#include "io/number.h"

namespace scancal {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";

// What follows 'key': in the dictionary, up to the comma behind it; commas inside brackets belong to it.
std::string_view ValueOf(std::string_view dictionary, std::string_view key) {
  const std::string quoted = std::string("'").append(key).append("'");
  const size_t key_start = dictionary.find(quoted);
  if (key_start == std::string_view::npos) return "";
  const size_t colon = dictionary.find(':', key_start + quoted.size());
  if (colon == std::string_view::npos) return "";
  size_t end = colon + 1;
  for (int depth = 0; end < dictionary.size(); ++end) {
    const char c = dictionary[end];
    if (depth == 0 && (c == ',' || c == '}')) break;
    if (c == '(' || c == '[') ++depth;
    if (c == ')' || c == ']') --depth;
  }
  return WithoutBlanks(dictionary.substr(colon + 1, end - colon - 1));
}

// (1000, 3) -> rows, columns; false if it is anything else.
bool ParseShape(std::string_view shape, NpyHeader* header) {
  if (!shape.starts_with('(') || !shape.ends_with(')')) return false;
  shape = shape.substr(1, shape.size() - 2);
  const size_t comma = shape.find(',');
  if (comma == std::string_view::npos) return false;
  const auto parse = [](std::string_view text, int64_t* number) {
    text = WithoutBlanks(text);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *number);
    return error == std::errc() && end == text.data() + text.size() && *number >= 0;
  };
  return parse(shape.substr(0, comma), &header->rows) && parse(shape.substr(comma + 1), &header->columns);
}

Result<NpyHeader> ParseDictionary(std::string_view dictionary, const std::string& name) {
  NpyHeader header;
  const std::string_view type = ValueOf(dictionary, "descr"), order = ValueOf(dictionary, "fortran_order"),
                         shape = ValueOf(dictionary, "shape");
  if (type != "'<f8'" && type != "'<f4'") {
    return Error{name + ": found the type " + Quoted(type) + ", expected '<f8' or '<f4'; save array.astype('<f8')"};
  }
  if (order != "False") {
    return Error{name + ": found fortran_order: " + Quoted(order) +
                 ", expected False; save numpy.ascontiguousarray(array)"};
  }
  if (!ParseShape(shape, &header)) {
    return Error{name + ": found the shape " + Quoted(shape) + ", expected (points, columns)"};
  }
  header.type = type.substr(1, 3);
  return header;
}

}  // namespace

Result<NpyHeader> ReadNpyHeader(InputFile& file) {
  constexpr size_t kLongestHeader = 65536;
  unsigned char start[12] = {};  // magic, major, minor, length (2 bytes in version 1, 4 bytes later)
  SCANCAL_ASSIGN_OR_RETURN(size_t count, file.Read(reinterpret_cast<char*>(start), 10));
  const std::string_view magic(reinterpret_cast<const char*>(start), kMagic.size());
  if (count < 10 || magic != kMagic) {
    return Error{file.name() + ": found " + (count == 0 ? "an empty file" : "other data") + ", expected a .npy array"};
  }
  const unsigned major = start[6];
  if (major < 1 || major > 3) {
    return Error{file.name() + ": found version " + std::to_string(major) + " of the .npy format, expected 1, 2 or 3"};
  }
  size_t size = start[8] + size_t{256} * start[9];
  if (major > 1) {
    SCANCAL_ASSIGN_OR_RETURN(count, file.Read(reinterpret_cast<char*>(start) + 10, 2));
    size += (size_t{start[10]} << 16U) + (size_t{start[11]} << 24U);
  }
  if (size > kLongestHeader) {
    return Error{file.name() + ": found a header of " + std::to_string(size) + " bytes, expected a plain array's"};
  }
  std::string dictionary(size, ' ');
  SCANCAL_ASSIGN_OR_RETURN(count, file.Read(dictionary.data(), size));
  if (count < size) return Error{file.name() + ": the file is cut off in its header"};
  SCANCAL_ASSIGN_OR_RETURN(NpyHeader header, ParseDictionary(dictionary, file.name()));
  header.bytes = static_cast<int64_t>((major > 1 ? 12 : 10) + size);
  return header;
}

std::string MakeNpyHeader(int64_t rows, int64_t columns) {
  std::string header(kMagic);
  header += {'\x01', '\x00', static_cast<char>(kNpyHeaderSize - 10), '\x00'};
  header += "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(rows) + ", " +
            std::to_string(columns) + "), }";
  header.resize(kNpyHeaderSize - 1, ' ');
  return header + '\n';
}

}  // namespace scancal
