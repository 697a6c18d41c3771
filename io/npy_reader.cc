#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>
#include "io/input_file.h"
#include "io/message.h"
#include "io/npy_header.h"
#include "io/scan_columns.h"
#include "io/scan_source.h"

namespace scancal {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays of type '<f8' are read as they stand");

class NpyReader : public ScanSource {
 public:
  NpyReader(const ScanFormat& format, InputFile file)
      : format_(format), file_(std::move(file)), wanted_rows_(format), invalid_(InvalidValue(format)) {}

  Result<void> ReadHeader();
  Result<bool> Next(ScanBatch* batch) override;
  int64_t bytes_read() const override { return header_.bytes + row_ * row_bytes_; }
  int64_t bytes_total() const override { return file_.size(); }

 private:
  Result<void> CheckSize() const;
  Result<size_t> ReadRows(size_t most);
  template <class Float>
  Result<void> Append(size_t rows, ScanBatch* batch);

  ScanFormat format_;
  InputFile file_;
  LineRange wanted_rows_;
  double invalid_;
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
  SCANCAL_ASSIGN_OR_RETURN(header_, ReadNpyHeader(file_));
  const auto declared = static_cast<int64_t>(format_.npy_columns.size());
  if (header_.columns != declared) {
    return Error{file_.name() + ": found the shape (" + std::to_string(header_.rows) + ", " +
                 std::to_string(header_.columns) + "), expected (points, " + std::to_string(declared) +
                 ") as declared by columns: [" + Listed(format_.npy_columns) + "]"};
  }
  row_bytes_ = header_.columns * (header_.type == "<f4" ? 4 : 8);
  SCANCAL_RETURN_IF_ERROR(CheckSize());
  SCANCAL_ASSIGN_OR_RETURN(columns_, ChooseColumns(format_, format_.npy_columns, file_.name() + ": columns"));
  if (header_.rows == 0) return NoPoints(format_, 0);
  row_ = std::clamp<int64_t>(wanted_rows_.first - 1, 0, header_.rows);
  if (row_ == header_.rows || wanted_rows_.last <= row_) return NoPoints(format_, header_.rows);
  return file_.Skip(row_ * row_bytes_);
}

Result<void> NpyReader::CheckSize() const {
  const int64_t found = file_.size() - header_.bytes;
  if (header_.rows <= found / row_bytes_ && header_.rows * row_bytes_ == found) return {};
  return Error{file_.name() + ": found " + std::to_string(found) + " bytes of numbers, expected " +
               std::to_string(header_.rows) + " rows of " + std::to_string(row_bytes_) + " bytes; the file is " +
               (header_.rows > found / row_bytes_ ? "probably cut off" : "followed by something else")};
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
  const int64_t left = std::min(header_.rows, wanted_rows_.last) - row_;
  const size_t rows = std::min(most, static_cast<size_t>(std::max<int64_t>(left, 0)));
  buffer_.resize(rows * static_cast<size_t>(row_bytes_));
  SCANCAL_ASSIGN_OR_RETURN(const size_t count, file_.Read(buffer_.data(), buffer_.size()));
  if (count < buffer_.size()) return Error{file_.name() + ": the file became shorter while it was read"};
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
        return WrongCell(file_.name() + ": row " + row, columns_[k].name, NumberKind::kInfinite,
                         value > 0 ? "inf" : "-inf");
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

Result<std::unique_ptr<ScanSource>> OpenNpy(const ScanFormat& format) {
  SCANCAL_ASSIGN_OR_RETURN(InputFile file, InputFile::Open(format.path));
  if (!file.regular()) return Error{file.name() + ": found a pipe or a device, expected a .npy file"};
  auto reader = std::make_unique<NpyReader>(format, std::move(file));
  SCANCAL_RETURN_IF_ERROR(reader->ReadHeader());
  return std::unique_ptr<ScanSource>(std::move(reader));
}

}  // namespace scancal
