// Heights in TIFF, read by libtiff strip by strip.
#include "io/image_rows.h"
#ifdef SCANCAL_TIFF
#include <tiffio.h>
#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <optional>
#include <utility>
#include "io/decoded_file.h"
#endif

namespace scancal {

bool StartsAsTiff(std::string_view start) {
  using namespace std::string_view_literals;
  return start.starts_with("II*\0"sv) || start.starts_with("MM\0*"sv) || start.starts_with("II+\0"sv) ||
         start.starts_with("MM\0+"sv);
}

#ifdef SCANCAL_TIFF

namespace {

class TiffRows : public ImageRows {
 public:
  explicit TiffRows(std::filesystem::path path) : path_(std::move(path)) {}
  TiffRows(const TiffRows&) = delete;
  TiffRows& operator=(const TiffRows&) = delete;
  ~TiffRows() override {
    if (tiff_ != nullptr) TIFFClose(tiff_);
  }
  int64_t bytes_read() const override { return height > 0 ? bytes_total_ * row_ / height : 0; }
  int64_t bytes_total() const override { return bytes_total_; }

  Result<void> ReadHeader() {
    SCANCAL_ASSIGN_OR_RETURN(const DecodedFile file, DecodedFile::Open(path_));
    if (!file.sized()) return Error{path_.string() + ": found a TIFF that is packed, expected it unpacked"};
    bytes_total_ = file.size();
    SCANCAL_RETURN_IF_ERROR(Open());
    const uint32_t columns = Field(TIFFTAG_IMAGEWIDTH), rows = Field(TIFFTAG_IMAGELENGTH);
    const uint16_t bits = Short(TIFFTAG_BITSPERSAMPLE), samples = Short(TIFFTAG_SAMPLESPERPIXEL);
    const uint16_t kind = Short(TIFFTAG_SAMPLEFORMAT);
    uint16_t photometric = PHOTOMETRIC_MINISBLACK;
    TIFFGetField(tiff_, TIFFTAG_PHOTOMETRIC, &photometric);
    whole = kind != SAMPLEFORMAT_IEEEFP;
    is_signed_ = kind == SAMPLEFORMAT_INT;
    const bool known = whole ? bits == 16 && (is_signed_ || kind == SAMPLEFORMAT_UINT) : bits == 32;
    if (!known || samples != 1 || photometric != PHOTOMETRIC_MINISBLACK)
      return Error{path_.string() + ": found an image of " + std::to_string(bits) + " bits, " +
                   (samples == 1 && photometric == PHOTOMETRIC_MINISBLACK ? whole ? "grey" : "floating point"
                                                                          : "colours, transparency or white as 0") +
                   ", expected heights: 16 bits, or 32 in floating point, grey"};
    if (TIFFIsTiled(tiff_) != 0)
      return Error{path_.string() + ": found an image in tiles, expected strips of rows; save it as PNG or .npy"};
    constexpr uint32_t kWidest = 1'000'000, kHighest = 100'000'000;
    if (columns == 0 || columns > kWidest || rows == 0 || rows > kHighest) return Damaged("its size");
    const size_t row_bytes = size_t{columns} * bits / 8;
    if (static_cast<size_t>(TIFFScanlineSize64(tiff_)) != row_bytes) return Damaged("the size of a row");
    // As of what is unpacked elsewhere: a strip may be named again and again.
    constexpr int64_t kSmall = int64_t{1} << 26, kMostGrowth = 500;
    if (static_cast<int64_t>(row_bytes) * rows > kSmall + kMostGrowth * bytes_total_)
      return Error{path_.string() + ": found " + std::to_string(rows) + " rows of " + std::to_string(columns) + " in " +
                   std::to_string(bytes_total_) + " bytes, expected a file that holds them"};
    if (TIFFLastDirectory(tiff_) == 0)
      return Error{path_.string() + ": found more than one image in it, expected one; save that of the heights alone"};
    width = columns;
    height = rows;
    bytes_.resize(row_bytes);
    title = std::string("TIFF, ") + (whole ? is_signed_ ? "signed 16 bits" : "16 bits" : "32 bits, floating point");
    return {};
  }

  Result<void> Read(std::vector<double>* row) override {
    if (TIFFReadScanline(tiff_, bytes_.data(), static_cast<uint32_t>(row_), 0) != 1)
      return Damaged("row " + std::to_string(row_ + 1));
    ++row_;
    row->clear();
    if (!whole) AppendNumbers<float>(bytes_, row);
    else if (is_signed_) AppendNumbers<int16_t>(bytes_, row);
    else AppendNumbers<uint16_t>(bytes_, row);
    return {};
  }

 private:
  Result<void> Open() {
    TIFFOpenOptions* const options = TIFFOpenOptionsAlloc();
    TIFFOpenOptionsSetMaxSingleMemAlloc(options, std::max<int64_t>(int64_t{1} << 24, 4 * bytes_total_));
    TIFFOpenOptionsSetErrorHandlerExtR(options, &TiffRows::Remember, this);
    TIFFOpenOptionsSetWarningHandlerExtR(options, &TiffRows::Doubt, this);
    tiff_ = TIFFOpenExt(path_.c_str(), "rm", options);  // m: read, not mapped; the file may shrink
    TIFFOpenOptionsFree(options);
    if (tiff_ == nullptr) return Damaged("its header");
    if (!complaint_.empty()) return Damaged("its strips");
    return {};
  }
  uint32_t Field(uint32_t tag) const {
    uint32_t value = 0;
    return TIFFGetField(tiff_, tag, &value) == 1 ? value : 0;
  }
  uint16_t Short(uint32_t tag) const {
    uint16_t value = 0;
    return TIFFGetFieldDefaulted(tiff_, tag, &value) == 1 ? value : 0;
  }
  Error Damaged(const std::string& what) const {
    return {path_.string() + ": " + what +
            " cannot be read as TIFF: " + (complaint_.empty() ? "it is damaged" : complaint_)};
  }
  // libtiff takes for pixels what lies behind a strip that is too short.
  static int Doubt(TIFF* tiff, void* rows, const char* module, const char* form, va_list values) {
    return std::strstr(form, "StripByteCounts") != nullptr ? Remember(tiff, rows, module, form, values) : 1;
  }
  static int Remember(TIFF* /*tiff*/, void* rows, const char* /*module*/, const char* form, va_list values) {
    char text[200];
    std::vsnprintf(text, sizeof text, form, values);
    std::string& complaint = static_cast<TiffRows*>(rows)->complaint_;
    if (complaint.empty()) complaint = text;
    return 1;
  }

  std::filesystem::path path_;
  TIFF* tiff_ = nullptr;
  std::string complaint_;  // the first
  std::string bytes_;
  bool is_signed_ = false;
  int64_t bytes_total_ = 0, row_ = 0;
};

}  // namespace

Result<std::unique_ptr<ImageRows>> OpenTiff(const std::filesystem::path& path) {
  auto rows = std::make_unique<TiffRows>(path);
  SCANCAL_RETURN_IF_ERROR(rows->ReadHeader());
  return std::unique_ptr<ImageRows>(std::move(rows));
}

#else

Result<std::unique_ptr<ImageRows>> OpenTiff(const std::filesystem::path& path) {
  return Error{path.string() +
               ": found a TIFF, which this program was built without; save it as PNG of 16 bits or .npy, "
               "or install libtiff-dev and build it again"};
}

#endif

}  // namespace scancal
