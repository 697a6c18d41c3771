// Images of heights: a profile a row, in grey (.png, .tif) or a two-dimensional array (.npy). What a pixel is, is
// declared: scale v + offset across the line, start + step k along it.
#include <png.h>
#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>
#include "io/decoded_file.h"
#include "io/file_kind.h"
#include "io/image_rows.h"
#include "io/message.h"
#include "io/npy.h"

namespace scancal {
namespace {

constexpr std::string_view kPngStart = "\x89PNG\r\n\x1a\n";

// libpng jumps over frames: those between it and setjmp hold nothing that wants to be destroyed.
class PngRows : public ImageRows {
 public:
  explicit PngRows(DecodedFile file) : file_(std::move(file)) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, &PngRows::Fail, [](png_structp, png_const_charp) {});
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  PngRows(const PngRows&) = delete;
  PngRows& operator=(const PngRows&) = delete;
  ~PngRows() override { png_destroy_read_struct(&png_, &info_, nullptr); }
  int64_t bytes_read() const override { return file_.bytes_read(); }
  int64_t bytes_total() const override { return file_.size(); }

  Result<void> ReadHeader() {
    if (info_ == nullptr) return Error{file_.name() + ": libpng cannot be used"};
    png_set_read_fn(png_, this, &PngRows::Feed);
    if (!ReadInfo()) return Damaged();
    height = png_get_image_height(png_, info_);
    width = png_get_image_width(png_, info_);
    const int bits = png_get_bit_depth(png_, info_), colours = png_get_color_type(png_, info_);
    if (bits != 16 || colours != PNG_COLOR_TYPE_GRAY)
      return Error{file_.name() + ": found an image of " + std::to_string(bits) + " bits, " +
                   (colours == PNG_COLOR_TYPE_GRAY ? "grey" : "colours or transparency") +
                   ", expected heights: 16 bits, grey"};
    if (png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE)
      return Error{file_.name() + ": found an interlaced image, expected one row after the other; save it without"};
    png_set_swap(png_);  // to little endian
    bytes_.resize(2 * static_cast<size_t>(width));
    title = "PNG";
    return {};
  }

  Result<void> Read(std::vector<double>* row) override {
    if (!ReadRow(++read_ == height)) return Damaged();
    row->clear();
    for (size_t k = 0; k < bytes_.size(); k += 2) {
      uint16_t pixel = 0;
      std::memcpy(&pixel, bytes_.data() + k, sizeof pixel);
      row->push_back(pixel);
    }
    return {};
  }

 private:
  bool ReadInfo() {
    constexpr png_uint_32 kWidest = 1'000'000, kHighest = 100'000'000;
    if (setjmp(png_jmpbuf(png_))) return false;
    png_set_user_limits(png_, kWidest, kHighest);
    png_read_info(png_, info_);
    return true;
  }
  bool ReadRow(bool last) {
    if (setjmp(png_jmpbuf(png_))) return false;
    png_read_row(png_, bytes_.data(), nullptr);
    if (last) png_read_end(png_, nullptr);
    return true;
  }

  Error Damaged() const { return error_.value_or(Error{file_.name() + ": cannot be read as PNG: " + complaint_}); }

  static void Fail(png_structp png, png_const_charp complaint) {
    auto* const self = static_cast<PngRows*>(png_get_error_ptr(png));
    std::strncpy(self->complaint_, complaint, sizeof self->complaint_ - 1);
    png_longjmp(png, 1);
  }
  static void Feed(png_structp png, png_bytep to, size_t size) {
    if (!static_cast<PngRows*>(png_get_io_ptr(png))->Fill(to, size)) png_error(png, "the file is cut off");
  }
  bool Fill(png_bytep to, size_t size) {
    const auto count = file_.Read(reinterpret_cast<char*>(to), size);
    if (!count.ok()) error_ = count.error();
    return count.ok() && *count == size;
  }

  DecodedFile file_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::vector<png_byte> bytes_;
  char complaint_[100] = {};
  std::optional<Error> error_;  // of the file
  int64_t read_ = 0;
};

class NpyRows : public ImageRows {
 public:
  explicit NpyRows(DecodedFile file) : file_(std::move(file)) {}
  int64_t bytes_read() const override { return file_.bytes_read(); }
  int64_t bytes_total() const override { return file_.size(); }

  Result<void> ReadHeader() {
    SCANCAL_ASSIGN_OR_RETURN(header_, ReadNpyHeader(&file_, true));
    SCANCAL_RETURN_IF_ERROR(CheckNpySize(header_, file_));
    height = header_.rows;
    width = header_.columns;
    whole = header_.type[1] != 'f';
    title = ".npy of " + header_.type;
    bytes_.resize(static_cast<size_t>(header_.row_bytes()));
    return {};
  }

  Result<void> Read(std::vector<double>* row) override {
    SCANCAL_ASSIGN_OR_RETURN(const size_t count, file_.Read(bytes_.data(), bytes_.size()));
    if (count < bytes_.size())
      return Error{file_.name() + ": found the end in row " + std::to_string(row_ + 1) + ", expected " +
                   std::to_string(height) + " rows; the file is cut off"};
    ++row_;
    row->clear();
    if (header_.type == "<f8") AppendNumbers<double>(bytes_, row);
    else if (header_.type == "<f4") AppendNumbers<float>(bytes_, row);
    else if (header_.type == "<u2") AppendNumbers<uint16_t>(bytes_, row);
    else if (header_.type == "<i2") AppendNumbers<int16_t>(bytes_, row);
    else AppendNumbers<int32_t>(bytes_, row);
    return {};
  }

 private:
  DecodedFile file_;
  NpyHeader header_;
  std::string bytes_;
  int64_t row_ = 0;
};

class HeightImageReader : public ScanReader {
 public:
  HeightImageReader(const ScanFormat& format, std::unique_ptr<ImageRows> rows, bool by_profile)
      : format_(format), layout_(*format.layout), rows_(std::move(rows)), by_profile_(by_profile) {
    if (format.lines) std::tie(first_row_, last_row_) = *format.lines;
    last_row_ = std::min(last_row_, rows_->height);
  }
  int64_t bytes_read() const override { return rows_->bytes_read(); }
  int64_t bytes_total() const override { return rows_->bytes_total(); }
  std::optional<double> FirstProfile() const override { return 1; }
  bool gives_heights() const override { return layout_.heights; }
  std::string Describe() const override {
    return rows_->title + ", " + std::to_string(rows_->height) + " rows of " + std::to_string(rows_->width) + ", " +
           layout_.value + " = " + Plainly(layout_.scale) + " v" + (layout_.offset < 0 ? " - " : " + ") +
           Plainly(std::abs(layout_.offset)) + " " + format_.units.length +
           (layout_.echo.empty() ? "" : ", " + layout_.echo);
  }

  Result<bool> Next(ScanBatch* batch) override {
    const double length = format_.units.length_in_mm;
    const double along = layout_.across == "bearing" ? format_.units.angle_in_rad : length;
    batch->names = {"angle", layout_.across, layout_.value, "profile"};
    batch->columns.resize(batch->names.size());
    for (std::vector<double>& column : batch->columns) column.clear();
    while (batch->size() < kBatchPoints && row_ < last_row_) {
      SCANCAL_RETURN_IF_ERROR(rows_->Read(&pixels_));
      if (++row_ < first_row_) continue;
      const auto profile = static_cast<double>(row_);
      for (size_t k = 0; k < pixels_.size(); ++k) {
        const double pixel = pixels_[k];
        if (std::isinf(pixel))
          return Error{format_.path.string() + ": row " + std::to_string(row_) + ": " + layout_.value + ": found " +
                       (pixel > 0 ? "inf" : "-inf") + Expectation(NumberKind::kInfinite)};
        if (IsMissing(pixel)) {
          ++missing_;
          continue;
        }
        batch->columns[0].push_back(by_profile_ ? profile : 0);
        batch->columns[1].push_back((layout_.start + layout_.step * static_cast<double>(k)) * along);
        batch->columns[2].push_back((layout_.scale * pixel + layout_.offset) * length);
        batch->columns[3].push_back(profile);
      }
    }
    any_point_ |= batch->size() > 0;
    if (!any_point_ && missing_ == 0) return NoPoints(format_, rows_->height);
    return batch->size() > 0;
  }

 private:
  bool IsMissing(double pixel) const {
    const std::vector<double>& more = format_.more_invalid;
    return std::isnan(pixel) || pixel == format_.invalid || std::find(more.begin(), more.end(), pixel) != more.end();
  }

  const ScanFormat format_;
  const WideLayout layout_;
  std::unique_ptr<ImageRows> rows_;
  bool by_profile_, any_point_ = false;
  int64_t first_row_ = 1, last_row_ = std::numeric_limits<int64_t>::max(), row_ = 0;
  std::vector<double> pixels_;
};

template <class Rows>
Result<std::unique_ptr<ImageRows>> OpenRows(const std::filesystem::path& path) {
  SCANCAL_ASSIGN_OR_RETURN(DecodedFile file, DecodedFile::Open(path));
  auto rows = std::make_unique<Rows>(std::move(file));
  SCANCAL_RETURN_IF_ERROR(rows->ReadHeader());
  return std::unique_ptr<ImageRows>(std::move(rows));
}

bool IsHeightImage(std::string_view start, const ScanFormat& format) {
  return start.starts_with(kPngStart) || StartsAsTiff(start) ||
         (StartsAsImage(start) && format.layout && format.layout->image);
}

Result<std::unique_ptr<ScanReader>> OpenHeightImage(const ScanFormat& format) {
  const std::string name = format.path.string();
  SCANCAL_ASSIGN_OR_RETURN(const std::string start, FirstBytes(format.path, 16));
  if (!StartsAsImage(start))
    return Error{name + ": found neither a PNG, a TIFF nor a .npy file, expected an image of heights"};
  if (!format.layout || !format.layout->image)
    return Error{name +
                 ": found an image, expected what its pixels are: layout: {image: y, scale: ..., start: ..., "
                 "step: ...}, with start and step along the line"};
  if (!format.text.where.empty()) return Error{name + ": where: an image has no columns, expected keep: {lines: ...}"};
  SCANCAL_ASSIGN_OR_RETURN(const bool by_profile, AnglesByProfile(format));
  SCANCAL_ASSIGN_OR_RETURN(std::unique_ptr<ImageRows> rows, start.starts_with(kPngStart)
                                                                ? OpenRows<PngRows>(format.path)
                                                            : StartsAsTiff(start) ? OpenTiff(format.path)
                                                                                  : OpenRows<NpyRows>(format.path));
  if (rows->whole && !format.layout->scaled)
    return Error{name + ": found whole numbers, expected what one is: layout: {image: ..., scale: ...}, in " +
                 format.units.length};
  return std::unique_ptr<ScanReader>(std::make_unique<HeightImageReader>(format, std::move(rows), by_profile));
}

}  // namespace

bool StartsAsImage(std::string_view start) {
  return start.starts_with(kPngStart) || start.starts_with(kNpyStart) || StartsAsTiff(start);
}

const FileKind kHeightImage = {"image", "images of heights (.png, .tif, .npy)", &IsHeightImage, &OpenHeightImage};

}  // namespace scancal
