#include "io/decoded_file.h"
#include <archive.h>
#include <archive_entry.h>
#include <zlib.h>
#include <algorithm>
#include <array>
#include <cstring>
#include <utility>
#include <vector>
#include "io/message.h"

namespace scancal {
namespace {

namespace fs = std::filesystem;

constexpr size_t kUnpackedPiece = size_t{1} << 16;
constexpr int64_t kSmall = int64_t{1} << 26, kMostGrowth = 500;

using Archive = std::unique_ptr<archive, decltype(&archive_read_free)>;

// One file after the other, as gzip has them; libarchive would not look at the check sums.
class Gunzip {
 public:
  Gunzip() { ready_ = inflateInit2(&stream_, 15 + 16) == Z_OK; }
  Gunzip(const Gunzip&) = delete;
  Gunzip& operator=(const Gunzip&) = delete;
  ~Gunzip() { inflateEnd(&stream_); }

  // feed(buffer, size): the next packed bytes.
  template <class Feed>
  Result<size_t> Read(char* buffer, size_t size, const Feed& feed) {
    stream_.next_out = reinterpret_cast<Bytef*>(buffer);
    stream_.avail_out = static_cast<uInt>(size);
    while (ready_ && stream_.avail_out > 0) {
      if (stream_.avail_in == 0) {
        SCANCAL_ASSIGN_OR_RETURN(const size_t count, feed(packed_.data(), packed_.size()));
        stream_.next_in = reinterpret_cast<Bytef*>(packed_.data());
        stream_.avail_in = static_cast<uInt>(count);
        if (count == 0 && ended_) break;
        if (count == 0) return Error{"the file is cut off"};
      }
      if (std::exchange(ended_, false)) inflateReset(&stream_);
      const int state = inflate(&stream_, Z_NO_FLUSH);
      if (state != Z_OK && state != Z_STREAM_END) return Error{stream_.msg ? stream_.msg : "damaged data"};
      ended_ = state == Z_STREAM_END;
    }
    return size - stream_.avail_out;
  }

 private:
  z_stream stream_ = {};
  bool ready_ = false, ended_ = false;
  std::vector<char> packed_ = std::vector<char>(kUnpackedPiece);
};

enum class Packing { kNone, kGzip, kZstandard, kZip };
enum class Utf16 { kNo, kLittle, kBig };

Packing PackingOf(std::string_view start) {
  using namespace std::string_view_literals;
  return start.starts_with("\x1f\x8b"sv)           ? Packing::kGzip
         : start.starts_with("\x28\xb5\x2f\xfd"sv) ? Packing::kZstandard
         : start.starts_with("PK\x03\x04"sv)       ? Packing::kZip
                                                   : Packing::kNone;
}

const char* Name(Packing packing) {
  return packing == Packing::kGzip ? "gzip" : packing == Packing::kZstandard ? "zstd" : "zip";
}

// By its mark; without one by the zeros that Latin text has in every second byte.
Utf16 Utf16Of(std::string_view start) {
  if (start.starts_with("\xFF\xFE")) return Utf16::kLittle;
  if (start.starts_with("\xFE\xFF")) return Utf16::kBig;
  size_t zeros[2] = {}, controls = 0;
  const size_t seen = std::min<size_t>(start.size(), 256) / 2 * 2;
  for (size_t i = 0; i < seen; ++i) {
    zeros[i % 2] += start[i] == '\0' ? 1 : 0;
    controls += start[i] > '\0' && start[i] < '\t' ? 1 : 0;
  }
  const size_t most = std::max(zeros[0], zeros[1]);
  if (seen < 8 || controls > 0 || std::min(zeros[0], zeros[1]) > 0 || 10 * most < 4 * seen) return Utf16::kNo;
  return zeros[1] > 0 ? Utf16::kLittle : Utf16::kBig;
}

void AppendUtf8(uint32_t c, std::string* text) {
  const auto byte = [&](uint32_t bits) { text->push_back(static_cast<char>(bits)); };
  if (c < 0x80) return byte(c);
  if (c < 0x800) {
    byte(0xC0U | c >> 6U);
  } else {
    if (c < 0x10000) {
      byte(0xE0U | c >> 12U);
    } else {
      byte(0xF0U | c >> 18U);
      byte(0x80U | (c >> 12U & 0x3FU));
    }
    byte(0x80U | (c >> 6U & 0x3FU));
  }
  byte(0x80U | (c & 0x3FU));
}

}  // namespace

struct DecodedFile::Impl {
  explicit Impl(InputFile input) : file(std::move(input)) {}

  InputFile file;
  std::string start;  // of the file, read to tell what it is
  int64_t taken = 0;  // bytes of the file
  std::vector<char> piece;
  Archive unpacker{nullptr, &archive_read_free};
  std::unique_ptr<Gunzip> gunzip;
  bool at_end = false;         // of what is unpacked
  std::optional<Error> error;  // of the file, while libarchive asks for it
  int64_t unpacked = 0;
  Utf16 utf16 = Utf16::kNo;
  std::string pending;  // unpacked, to be given next
  std::string wrapping;
  uint32_t high = 0;   // half of a pair of UTF-16
  std::string odd;     // half of a unit of UTF-16
  std::string member;  // wanted; empty: the only one

  Result<size_t> ReadFile(char* buffer, size_t size) {
    const size_t known = std::min(size, start.size());
    std::memcpy(buffer, start.data(), known);
    start.erase(0, known);
    size_t filled = known;
    if (filled < size) {
      SCANCAL_ASSIGN_OR_RETURN(const size_t count, file.Read(buffer + filled, size - filled));
      filled += count;
    }
    taken += static_cast<int64_t>(filled);
    return filled;
  }

  static la_ssize_t Feed(archive* /*archive*/, void* impl, const void** buffer) {
    auto* const self = static_cast<Impl*>(impl);
    self->piece.resize(kUnpackedPiece);
    const Result<size_t> count = self->ReadFile(self->piece.data(), kUnpackedPiece);
    *buffer = self->piece.data();
    if (count.ok()) return static_cast<la_ssize_t>(*count);
    self->error = count.error();
    return -1;
  }

  Error Damaged() const {
    if (error) return *error;
    const char* const reason = archive_error_string(unpacker.get());
    return {file.name() + ": cannot be unpacked: " + (reason ? reason : "damaged data")};
  }

  Result<void> OpenArchive(Packing packing) {
    if (packing == Packing::kGzip) {
      gunzip = std::make_unique<Gunzip>();
      return {};
    }
    unpacker.reset(archive_read_new());
    if (packing == Packing::kZstandard) archive_read_support_filter_zstd(unpacker.get());
    if (packing == Packing::kZip) archive_read_support_format_zip(unpacker.get());
    else archive_read_support_format_raw(unpacker.get());
    if (archive_read_open(unpacker.get(), this, nullptr, &Feed, nullptr) != ARCHIVE_OK) return Damaged();
    return FindMember();
  }

  Result<void> FindMember() {
    std::vector<std::string> others;
    for (archive_entry* entry = nullptr;;) {
      const int found = archive_read_next_header(unpacker.get(), &entry);
      if (found == ARCHIVE_EOF)
        return Error{file.name() + ": found no file '" + member + "' in it, but " + Listed(others)};
      if (found != ARCHIVE_OK && found != ARCHIVE_WARN) return Damaged();
      if (archive_entry_filetype(entry) == AE_IFDIR) continue;
      const char* const utf8 = archive_entry_pathname_utf8(entry);
      const char* const name = utf8 ? utf8 : archive_entry_pathname(entry);
      if (member.empty() || (name && member == name)) return {};
      others.emplace_back(name ? name : "?");
    }
  }

  // Of a .zip whose member is not named: another one behind it.
  Result<void> CheckOnly() {
    archive_entry* entry = nullptr;
    if (!unpacker || !member.empty() || wrapping.find("zip") != 0) return {};
    while (archive_read_next_header(unpacker.get(), &entry) == ARCHIVE_OK)
      if (archive_entry_filetype(entry) != AE_IFDIR)
        return Error{file.name() + ": found more than one file in it, expected one, or its name: " + file.name() +
                     "/left.csv"};
    return {};
  }

  // Unpacked bytes; fewer than asked for only at the end.
  Result<size_t> ReadBytes(char* buffer, size_t size) {
    if (!is_packed()) return ReadFile(buffer, size);
    size_t filled = 0;
    while (filled < size && !at_end) {
      SCANCAL_ASSIGN_OR_RETURN(const size_t count, Unpack(buffer + filled, size - filled));
      at_end = count == 0;
      if (at_end) SCANCAL_RETURN_IF_ERROR(CheckOnly());
      filled += count;
      unpacked += static_cast<int64_t>(count);
      if (unpacked > kSmall && unpacked / kMostGrowth > taken)
        return Error{file.name() + ": grows by more than 500 times as it is unpacked, expected text with numbers"};
    }
    return filled;
  }

  bool is_packed() const { return unpacker || gunzip; }

  // Some bytes, none at the end.
  Result<size_t> Unpack(char* buffer, size_t size) {
    if (gunzip) {
      const auto bytes = gunzip->Read(buffer, size, [&](char* to, size_t most) { return ReadFile(to, most); });
      return bytes.ok() ? bytes : Error{file.name() + ": cannot be unpacked: " + bytes.error().message};
    }
    const la_ssize_t count = archive_read_data(unpacker.get(), buffer, size);
    if (count < 0) return Damaged();
    return static_cast<size_t>(count);
  }

  void Decode(const char* bytes, size_t size) {
    odd.append(bytes, size);
    size_t at = 0;
    for (; at + 1 < odd.size(); at += 2) {
      const auto first = static_cast<unsigned char>(odd[at]), second = static_cast<unsigned char>(odd[at + 1]);
      const uint32_t unit = utf16 == Utf16::kLittle ? first | uint32_t{second} << 8U : second | uint32_t{first} << 8U;
      const bool follows = unit >= 0xDC00 && unit < 0xE000;
      if (std::exchange(high, 0) != 0 && !follows) AppendUtf8(0xFFFD, &pending);
      if (unit >= 0xD800 && unit < 0xDC00) high = unit;
      else if (follows) AppendUtf8(0xFFFD, &pending);
      else AppendUtf8(unit, &pending);
    }
    odd.erase(0, at);
  }
};

DecodedFile::DecodedFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
DecodedFile::DecodedFile(DecodedFile&&) noexcept = default;
DecodedFile& DecodedFile::operator=(DecodedFile&&) noexcept = default;
DecodedFile::~DecodedFile() = default;

Result<DecodedFile> DecodedFile::Open(const fs::path& path) {
  const fs::path archive = ArchiveOf(path);
  SCANCAL_ASSIGN_OR_RETURN(InputFile file, InputFile::Open(archive));
  auto impl = std::make_unique<Impl>(std::move(file));
  if (archive != path) impl->member = path.lexically_relative(archive).generic_string();
  std::array<char, 512> start = {};
  SCANCAL_ASSIGN_OR_RETURN(size_t count, impl->file.Read(start.data(), start.size()));
  impl->start.assign(start.data(), count);
  if (const Packing packing = PackingOf(impl->start); packing != Packing::kNone) {
    impl->wrapping = Name(packing);
    SCANCAL_RETURN_IF_ERROR(impl->OpenArchive(packing));
    SCANCAL_ASSIGN_OR_RETURN(count, impl->ReadBytes(start.data(), start.size()));
    impl->pending.assign(start.data(), count);
  }
  std::string& known = impl->is_packed() ? impl->pending : impl->start;
  impl->utf16 = Utf16Of(known);
  if (impl->utf16 != Utf16::kNo) {
    impl->wrapping += impl->wrapping.empty() ? "UTF-16" : ", UTF-16";
    const std::string bytes = std::exchange(known, "");
    impl->taken += impl->is_packed() ? 0 : static_cast<int64_t>(bytes.size());
    impl->Decode(bytes.data(), bytes.size());
  }
  return DecodedFile(std::move(impl));
}

Result<size_t> DecodedFile::Read(char* buffer, size_t size) {
  if (impl_->utf16 == Utf16::kNo && impl_->pending.empty()) return impl_->ReadBytes(buffer, size);
  std::string& pending = impl_->pending;
  while (pending.size() < size) {
    std::array<char, kUnpackedPiece> bytes;
    const size_t most = impl_->utf16 == Utf16::kNo ? std::min(kUnpackedPiece, size - pending.size()) : kUnpackedPiece;
    SCANCAL_ASSIGN_OR_RETURN(const size_t count, impl_->ReadBytes(bytes.data(), most));
    if (impl_->utf16 == Utf16::kNo) pending.append(bytes.data(), count);
    else impl_->Decode(bytes.data(), count);
    if (count < most) break;
  }
  const size_t given = std::min(size, pending.size());
  std::memcpy(buffer, pending.data(), given);
  pending.erase(0, given);
  return given;
}

Result<void> DecodedFile::Skip(int64_t bytes) {
  std::vector<char> passed(kUnpackedPiece);
  while (bytes > 0) {
    if (sized() && impl_->start.empty()) return impl_->file.Skip(bytes);
    // The rest of what was read already, then piece by piece.
    const size_t most = sized() ? impl_->start.size() : passed.size();
    const auto size = static_cast<size_t>(std::min<int64_t>(bytes, static_cast<int64_t>(most)));
    SCANCAL_ASSIGN_OR_RETURN(const size_t count, Read(passed.data(), size));
    if (count < size) return {};  // who reads on will see that it ended
    bytes -= static_cast<int64_t>(count);
  }
  return {};
}

std::string_view DecodedFile::start() const {
  return impl_->is_packed() || impl_->utf16 != Utf16::kNo ? impl_->pending : impl_->start;
}
bool DecodedFile::sized() const { return impl_->file.regular() && !impl_->is_packed() && impl_->utf16 == Utf16::kNo; }
const std::string& DecodedFile::name() const { return impl_->file.name(); }
int64_t DecodedFile::size() const { return impl_->file.size(); }
int64_t DecodedFile::bytes_read() const { return impl_->taken; }
const std::string& DecodedFile::wrapping() const { return impl_->wrapping; }

fs::path ArchiveOf(const fs::path& path) {
  std::error_code ignored;
  for (fs::path parent = path.parent_path(); parent.has_filename(); parent = parent.parent_path()) {
    std::string extension = parent.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) { return c | 0x20; });
    if (extension == ".zip" && fs::is_regular_file(parent, ignored)) return parent;
  }
  return path;
}

}  // namespace scancal
