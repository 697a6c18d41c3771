// A text file of any size, read block by block, each block a number of whole lines.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include "io/input_file.h"
#include "io/result.h"

namespace scancal {

// Every line ends with '\n', also a last one that has none in the file: whoever walks over a line needs no other check
// for its end. A byte order mark is skipped. Read() rather than a mapping: a pipe will do, and a file that shrinks
// meanwhile is an error instead of a SIGBUS.
class TextLines {
 public:
  static Result<TextLines> Open(const std::filesystem::path& path);
  // Makes sure that there is a line; false at the end of the file. Invalidates pointers into the old block.
  Result<bool> Fill();
  const char* begin() const { return begin_; }  // the next line
  const char* end() const { return end_; }      // of the last whole line in the block
  void SkipTo(const char* line) { begin_ = line; }
  // The next line, without its end; nothing at the end of the file.
  Result<std::optional<std::string_view>> TakeLine();
  const std::string& name() const { return file_.name(); }
  int64_t bytes_read() const { return bytes_read_ - (filled_end_ - begin_); }
  int64_t bytes_total() const { return file_.size(); }

 private:
  explicit TextLines(InputFile file);
  Result<void> ReadMore();
  Result<void> CheckEncoding();

  InputFile file_;
  std::vector<char> buffer_;
  const char* begin_;       // lines not yet taken: [begin_, end_)
  const char* end_;         //
  const char* filled_end_;  // an unfinished line: [end_, filled_end_)
  int64_t bytes_read_ = 0;
  bool at_end_ = false;
};

}  // namespace scancal
