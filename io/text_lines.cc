#include "io/text_lines.h"
#include <algorithm>
#include <cstring>
#include <utility>
#include "io/utf8.h"

namespace scancal {
namespace {

constexpr size_t kBlock = size_t{1} << 20;  // stays in the second-level cache
constexpr size_t kLongestLine = size_t{1} << 26;

}  // namespace

TextLines::TextLines(InputFile file)
    : file_(std::move(file)),
      buffer_(kBlock + 1),
      begin_(buffer_.data()),
      end_(buffer_.data()),
      filled_end_(buffer_.data()) {}

Result<TextLines> TextLines::Open(const std::filesystem::path& path) {
  SCANCAL_ASSIGN_OR_RETURN(InputFile file, InputFile::Open(path));
  TextLines lines(std::move(file));
  SCANCAL_RETURN_IF_ERROR(lines.ReadMore());
  SCANCAL_RETURN_IF_ERROR(lines.CheckEncoding());
  return lines;
}

Result<void> TextLines::CheckEncoding() {
  const std::string_view text(begin_, static_cast<size_t>(filled_end_ - begin_));
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    return Error{name() + ": found UTF-16 text, expected UTF-8; save the file as UTF-8 or plain text"};
  }
  if (text.substr(0, 4096).find('\0') != std::string_view::npos) {
    return Error{name() + ": found binary data, expected text with commas"};
  }
  const auto mark_size = static_cast<std::ptrdiff_t>(text.size() - WithoutByteOrderMark(text).size());
  begin_ += mark_size;
  end_ = std::max(begin_, end_);
  return {};
}

// Moves the unfinished line to the front and reads on behind it, until there is a whole line or the file ends.
Result<void> TextLines::ReadMore() {
  size_t filled = static_cast<size_t>(filled_end_ - begin_);
  std::memmove(buffer_.data(), begin_, filled);
  size_t whole = 0;
  while (whole == 0 && !at_end_) {
    if (filled + 1 == buffer_.size()) {
      if (filled > kLongestLine) return Error{name() + ": found a line of more than 64 MB, expected lines of text"};
      buffer_.resize(2 * buffer_.size());
    }
    const size_t room = buffer_.size() - 1 - filled;  // the last byte is kept for a line end that is missing
    SCANCAL_ASSIGN_OR_RETURN(const size_t count, file_.Read(buffer_.data() + filled, room));
    bytes_read_ += static_cast<int64_t>(count);
    filled += count;
    at_end_ = count < room;
    if (at_end_ && filled > 0 && buffer_[filled - 1] != '\n') buffer_[filled++] = '\n';
    const std::string_view text(buffer_.data(), filled);
    whole = text.rfind('\n') + 1;  // npos + 1 is 0
  }
  begin_ = buffer_.data();
  end_ = begin_ + whole;
  filled_end_ = begin_ + filled;
  return {};
}

Result<bool> TextLines::Fill() {
  if (begin_ == end_ && !at_end_) SCANCAL_RETURN_IF_ERROR(ReadMore());
  return begin_ != end_;
}

Result<std::optional<std::string_view>> TextLines::TakeLine() {
  SCANCAL_ASSIGN_OR_RETURN(const bool filled, Fill());
  if (!filled) return std::optional<std::string_view>();
  const auto* const line_end = static_cast<const char*>(std::memchr(begin_, '\n', static_cast<size_t>(end_ - begin_)));
  const std::string_view line(begin_, static_cast<size_t>(line_end - begin_));
  begin_ = line_end + 1;
  return std::optional(line);
}

}  // namespace scancal
