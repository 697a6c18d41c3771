#include "io/npy.h"
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>
#include "io/decoded_file.h"
#include "io/message.h"
#include "io/number.h"
#include "io/scan.h"

namespace scancal {
namespace {

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

Result<NpyHeader> ParseDictionary(std::string_view dictionary, const std::string& name, bool image) {
  NpyHeader header;
  const std::string_view type = ValueOf(dictionary, "descr"), order = ValueOf(dictionary, "fortran_order"),
                         shape = ValueOf(dictionary, "shape");
  const bool whole = type == "'<u2'" || type == "'<i2'" || type == "'<i4'";
  if (type != "'<f8'" && type != "'<f4'" && !(image && whole)) {
    return Error{name + ": found the type " + Quoted(type) + ", expected '<f8'" +
                 (image ? ", '<f4', '<u2', '<i2' or '<i4'" : " or '<f4'") + "; save array.astype('<f8')"};
  }
  if (order != "False") {
    return Error{name + ": found fortran_order: " + Quoted(order) +
                 ", expected False; save numpy.ascontiguousarray(array)"};
  }
  if (!ParseShape(shape, &header)) {
    return Error{name + ": found the shape " + Quoted(shape) + ", expected " +
                 (image ? "(rows, columns)" : "(points, columns)")};
  }
  header.type = type.substr(1, 3);
  return header;
}

}  // namespace

Result<NpyHeader> ReadNpyHeader(DecodedFile* input, bool image) {
  DecodedFile& file = *input;
  constexpr size_t kLongestHeader = 65536;
  unsigned char start[12] = {};  // magic, major, minor, length (2 bytes in version 1, 4 bytes later)
  SCANCAL_ASSIGN_OR_RETURN(size_t count, file.Read(reinterpret_cast<char*>(start), 10));
  const std::string_view magic(reinterpret_cast<const char*>(start), kNpyStart.size());
  if (count < 10 || magic != kNpyStart) {
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
  SCANCAL_ASSIGN_OR_RETURN(NpyHeader header, ParseDictionary(dictionary, file.name(), image));
  header.bytes = static_cast<int64_t>((major > 1 ? 12 : 10) + size);
  return header;
}

Result<void> CheckNpySize(const NpyHeader& header, const DecodedFile& file) {
  constexpr int64_t kMost = int64_t{1} << 56, kWidest = 1'000'000;
  const bool possible = header.columns <= kWidest && header.rows <= kMost / std::max<int64_t>(1, header.columns);
  if (!file.sized() && possible) return {};  // nobody knows yet
  if (!file.sized())
    return Error{file.name() + ": found a header of " + std::to_string(header.rows) + " rows of " +
                 std::to_string(header.columns) + " numbers, expected at most a million a row"};
  const int64_t found = file.size() - header.bytes;
  const bool fits = header.columns > 0 && header.columns <= file.size();  // else the product may be too large
  const int64_t row = fits ? header.row_bytes() : 0;
  if (fits && header.rows <= found / row && header.rows * row == found) return {};
  const bool longer = !fits || header.rows > found / row;
  return Error{file.name() + ": found " + std::to_string(found) + " bytes of numbers, expected " +
               std::to_string(header.rows) + " rows of " +
               (fits ? std::to_string(row) + " bytes" : std::to_string(header.columns) + " numbers") +
               "; the file is " + (longer ? "probably cut off" : "followed by something else")};
}

namespace {

static_assert(std::endian::native == std::endian::little, "arrays of type '<f8' are read as they stand");

class NpyReader : public ScanReader {
 public:
  NpyReader(const ScanFormat& format, DecodedFile file) : format_(format), file_(std::move(file)) {
    if (format.lines) std::tie(first_row_, last_row_) = *format.lines;
    if (format.invalid) invalid_ = *format.invalid;
  }

  Result<void> ReadHeader();
  std::string Describe() const override { return file_.wrapping(); }
  Result<bool> Next(ScanBatch* batch) override;
  int64_t bytes_read() const override { return header_.bytes + row_ * row_bytes_; }
  int64_t bytes_total() const override { return header_.bytes + header_.rows * row_bytes_; }

 private:
  Result<size_t> ReadRows(size_t most);
  template <class Float>
  Result<void> Append(size_t rows, ScanBatch* batch);

  ScanFormat format_;
  DecodedFile file_;
  int64_t first_row_ = 1, last_row_ = std::numeric_limits<int64_t>::max();  // wanted, 1-based
  double invalid_ = std::numeric_limits<double>::quiet_NaN();               // equals no number
  NpyHeader header_;
  std::vector<ChosenColumn> columns_;
  int64_t row_bytes_ = 0;
  int64_t row_ = 0;  // rows read or skipped so far
  std::vector<char> buffer_;
};

Result<void> NpyReader::ReadHeader() {
  if (format_.npy_columns.empty()) {
    return Error{file_.name() + ": the data set does not say what its columns are; add columns: [angle, y, z]"};
  }
  SCANCAL_ASSIGN_OR_RETURN(header_, ReadNpyHeader(&file_));
  const auto declared = static_cast<int64_t>(format_.npy_columns.size());
  if (header_.columns != declared) {
    return Error{file_.name() + ": found the shape (" + std::to_string(header_.rows) + ", " +
                 std::to_string(header_.columns) + "), expected (points, " + std::to_string(declared) +
                 ") as declared by columns: [" + Listed(format_.npy_columns) + "]"};
  }
  SCANCAL_RETURN_IF_ERROR(CheckNpySize(header_, file_));
  row_bytes_ = header_.row_bytes();
  SCANCAL_ASSIGN_OR_RETURN(columns_, ChooseColumns(format_, format_.npy_columns, file_.name() + ": columns"));
  if (header_.rows == 0) return NoPoints(format_, 0);
  row_ = std::clamp<int64_t>(first_row_ - 1, 0, header_.rows);
  if (row_ == header_.rows || last_row_ <= row_) return NoPoints(format_, header_.rows);
  return file_.Skip(row_ * row_bytes_);
}

Result<bool> NpyReader::Next(ScanBatch* batch) {
  batch->names.clear();
  for (const ChosenColumn& column : columns_) batch->names.push_back(column.name);
  batch->columns.resize(columns_.size());
  for (std::vector<double>& column : batch->columns) column.clear();
  while (batch->size() < kBatchPoints) {
    SCANCAL_ASSIGN_OR_RETURN(const size_t rows, ReadRows(kBatchPoints - batch->size()));
    if (rows == 0) break;
    SCANCAL_RETURN_IF_ERROR(header_.type == "<f4" ? Append<float>(rows, batch) : Append<double>(rows, batch));
    row_ += static_cast<int64_t>(rows);
  }
  return batch->size() > 0;
}

Result<size_t> NpyReader::ReadRows(size_t most) {
  const int64_t left = std::min(header_.rows, last_row_) - row_;
  const size_t rows = std::min(most, static_cast<size_t>(std::max<int64_t>(left, 0)));
  buffer_.resize(rows * static_cast<size_t>(row_bytes_));
  SCANCAL_ASSIGN_OR_RETURN(const size_t count, file_.Read(buffer_.data(), buffer_.size()));
  if (count < buffer_.size())
    return Error{file_.name() + ": found the end after row " +
                 std::to_string(row_ + static_cast<int64_t>(count) / row_bytes_) + ", expected " +
                 std::to_string(header_.rows) + " rows: " +
                 (file_.sized()              ? "the file became shorter while it was read"
                  : file_.wrapping().empty() ? "the pipe was closed early"
                                             : "the file was probably cut off before it was packed")};
  return rows;
}

template <class Float>
Result<void> NpyReader::Append(size_t rows, ScanBatch* batch) {
  const auto invalid = static_cast<Float>(invalid_);  // 0.1 stands in a float32 file as float32
  for (size_t i = 0; i < rows; ++i) {
    bool missing = false;
    for (size_t k = 0; k < columns_.size(); ++k) {
      Float value = 0;
      std::memcpy(&value, buffer_.data() + i * static_cast<size_t>(row_bytes_) + columns_[k].index * sizeof(Float),
                  sizeof(Float));
      if (std::isinf(value)) {
        const std::string row = std::to_string(row_ + static_cast<int64_t>(i) + 1);
        return Error{file_.name() + ": row " + row + ": " + columns_[k].name + ": found " +
                     (value > 0 ? "inf" : "-inf") + Expectation(NumberKind::kInfinite)};
      }
      missing |= std::isnan(value) || value == invalid;
      batch->columns[k].push_back(static_cast<double>(value) * columns_[k].factor);
    }
    if (!missing) continue;
    ++missing_;
    for (std::vector<double>& column : batch->columns) column.pop_back();
  }
  return {};
}

}  // namespace

std::string MakeNpyHeader(int64_t rows, int64_t columns) {
  std::string header(kNpyStart);
  header += {'\x01', '\x00', static_cast<char>(kNpyHeaderSize - 10), '\x00'};
  header += "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(rows) + ", " +
            std::to_string(columns) + "), }";
  header.resize(kNpyHeaderSize - 1, ' ');
  return header + '\n';
}

Result<std::unique_ptr<ScanReader>> OpenNpy(const ScanFormat& format, DecodedFile file) {
  auto reader = std::make_unique<NpyReader>(format, std::move(file));
  SCANCAL_RETURN_IF_ERROR(reader->ReadHeader());
  return std::unique_ptr<ScanReader>(std::move(reader));
}

}  // namespace scancal
