// Clouds with a number of columns a point: PLY (format 1.0) and PCD (.7), as text or in binary, little endian. A cloud
// of places alone is refused: what is calibrated here are the angles that it was put together with.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include "io/decoded_file.h"
#include "io/file_kind.h"
#include "io/message.h"
#include "io/number.h"

namespace scancal {
namespace {

constexpr size_t kLongestCloudLine = size_t{1} << 20;  // and record

// Lines of the head, then lines or records.
class CloudBytes {
 public:
  explicit CloudBytes(DecodedFile file) : file_(std::move(file)) {}
  const std::string& name() const { return file_.name(); }
  int64_t bytes_read() const { return file_.bytes_read(); }
  int64_t bytes_total() const { return file_.size(); }
  const std::string& wrapping() const { return file_.wrapping(); }
  int64_t line() const { return line_; }

  // Without its end; nothing at the end of the file.
  Result<std::optional<std::string_view>> Line() {
    size_t seen = at_;
    for (;;) {
      if (const size_t end = bytes_.find('\n', seen); end != std::string::npos) return TakeLine(end, end + 1);
      seen = bytes_.size() - at_;
      if (seen > kLongestCloudLine)
        return Error{name() + ": found a line of more than 1 MB, expected lines of a head or of numbers"};
      SCANCAL_ASSIGN_OR_RETURN(const bool more, More());
      if (!more) break;
    }
    if (at_ == bytes_.size()) return std::optional<std::string_view>();
    return TakeLine(bytes_.size(), bytes_.size());
  }

  // So many bytes; nullptr: fewer are left.
  Result<const char*> Record(size_t size) {
    while (bytes_.size() - at_ < size) {
      SCANCAL_ASSIGN_OR_RETURN(const bool more, More());
      if (!more) return static_cast<const char*>(nullptr);
    }
    at_ += size;
    return bytes_.data() + at_ - size;
  }

 private:
  Result<bool> More() {
    bytes_.erase(0, std::exchange(at_, 0));
    const size_t had = bytes_.size();
    bytes_.resize(had + kLongestCloudLine);
    SCANCAL_ASSIGN_OR_RETURN(const size_t count, file_.Read(bytes_.data() + had, kLongestCloudLine));
    bytes_.resize(had + count);
    return count > 0;
  }
  std::optional<std::string_view> TakeLine(size_t end, size_t next) {
    const std::string_view line = std::string_view(bytes_).substr(at_, end - at_);
    at_ = next;
    ++line_;
    return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
  }

  DecodedFile file_;
  std::string bytes_;
  size_t at_ = 0;
  int64_t line_ = 0;
};

struct CloudField {
  std::string name;
  char type = 'F';  // F, I, U as in PCD
  size_t size = 4;
  size_t count = 1;
};

struct CloudHead {
  std::vector<CloudField> fields;
  bool ascii = true;
  int64_t points = 0;
  bool goes_on = false;  // other elements follow the points
};

bool IsCount(const std::string& word, int64_t most, int64_t* number) {
  const ParsedNumber parsed = ParseNumber(word);
  const bool whole = parsed.kind == NumberKind::kNumber && parsed.value >= 0 &&
                     parsed.value <= static_cast<double>(most) && std::floor(parsed.value) == parsed.value;
  if (whole) *number = static_cast<int64_t>(parsed.value);
  return whole;
}

constexpr int64_t kMostPoints = int64_t{1} << 52;

Error WrongHead(const CloudBytes& bytes, const std::string& found, const std::string& expected) {
  return {bytes.name() + ":" + std::to_string(bytes.line()) + ": found " + Quoted(found) + ", expected " + expected};
}

Result<CloudField> PlyProperty(const CloudBytes& bytes, const std::string& line,
                               const std::vector<std::string>& words) {
  static const std::map<std::string, std::pair<char, size_t>> kTypes = {
      {"char", {'I', 1}},  {"int8", {'I', 1}},    {"uchar", {'U', 1}},  {"uint8", {'U', 1}},
      {"short", {'I', 2}}, {"int16", {'I', 2}},   {"ushort", {'U', 2}}, {"uint16", {'U', 2}},
      {"int", {'I', 4}},   {"int32", {'I', 4}},   {"uint", {'U', 4}},   {"uint32", {'U', 4}},
      {"float", {'F', 4}}, {"float32", {'F', 4}}, {"double", {'F', 8}}, {"float64", {'F', 8}}};
  const auto type = words.size() == 3 ? kTypes.find(words[1]) : kTypes.end();
  if (type == kTypes.end()) return WrongHead(bytes, line, "a property of one number: property float y");
  return CloudField{words[2], type->second.first, type->second.second};
}

Result<CloudHead> ReadPlyHead(CloudBytes* bytes) {
  CloudHead head;
  bool any = false, of_points = false, behind = false;
  for (;;) {
    SCANCAL_ASSIGN_OR_RETURN(const auto taken, bytes->Line());
    if (!taken) return Error{bytes->name() + ": the file is cut off in its header"};
    const std::string line(*taken);
    const std::vector<std::string> words = SplitCells(line, ' ');
    if (bytes->line() == 1 && words[0] != "ply")
      return Error{bytes->name() + ":1: found other data, expected the line ply that a PLY begins with"};
    if (words[0].empty() || words[0] == "comment" || words[0] == "obj_info" || words[0] == "ply") continue;
    if (words[0] == "end_header") break;
    if (words[0] == "format") {
      head.ascii = words.size() > 1 && words[1] == "ascii";
      if (!head.ascii && (words.size() < 2 || words[1] != "binary_little_endian"))
        return WrongHead(*bytes, line, "format ascii or binary_little_endian");
    } else if (words[0] == "element") {
      const bool points = words.size() == 3 && words[1] == "vertex";
      if (points && !IsCount(words[2], kMostPoints, &head.points))
        return WrongHead(*bytes, line, "element vertex COUNT");
      if (!points && !any) return WrongHead(*bytes, line, "element vertex first");
      any |= points;
      behind |= !points;
      head.goes_on = behind;
      of_points = points && !behind;
    } else if (words[0] == "property" && of_points) {
      SCANCAL_ASSIGN_OR_RETURN(CloudField field, PlyProperty(*bytes, line, words));
      head.fields.push_back(std::move(field));
    }
  }
  return head;
}

Result<CloudHead> ReadPcdHead(CloudBytes* bytes) {
  CloudHead head;
  int64_t width = 0, height = 1, points = -1;
  for (;;) {
    SCANCAL_ASSIGN_OR_RETURN(const auto taken, bytes->Line());
    if (!taken)
      return Error{bytes->name() + ": found " + (head.fields.empty() ? "no line FIELDS" : "no line DATA") +
                   ", expected the header of a PCD; it is cut off, or another kind of file"};
    const std::string line(*taken);
    const std::vector<std::string> words = SplitCells(line, ' ');
    if (words[0].empty() || words[0].starts_with('#')) continue;
    const auto each = [&](const auto& set) {  // of the fields
      bool right = words.size() == head.fields.size() + 1;
      for (size_t k = 0; right && k < head.fields.size(); ++k) right = set(&head.fields[k], words[k + 1]);
      return right;
    };
    bool right = true;
    if (words[0] == "FIELDS" || words[0] == "COLUMNS") {
      head.fields.clear();
      for (size_t k = 1; k < words.size(); ++k) head.fields.push_back({words[k]});
    } else if (words[0] == "SIZE" || words[0] == "COUNT") {
      const bool is_size = words[0] == "SIZE";
      right = each([&](CloudField* field, const std::string& word) {
        int64_t number = 0;
        const bool known = IsCount(word, is_size ? 8 : 100'000, &number);
        (is_size ? field->size : field->count) = static_cast<size_t>(number);
        return known && (!is_size || number == 1 || number == 2 || number == 4 || number == 8);
      });
    } else if (words[0] == "TYPE") {
      right = each([](CloudField* field, const std::string& word) {
        field->type = word[0];
        return word == "F" || word == "I" || word == "U";
      });
    } else if (words[0] == "WIDTH" || words[0] == "HEIGHT" || words[0] == "POINTS") {
      int64_t* const number = words[0] == "WIDTH" ? &width : words[0] == "HEIGHT" ? &height : &points;
      right = words.size() == 2 && IsCount(words[1], kMostPoints, number);
    } else if (words[0] == "DATA") {
      head.ascii = words.size() == 2 && words[1] == "ascii";
      if (!head.ascii && (words.size() < 2 || words[1] != "binary"))
        return WrongHead(*bytes, line, "DATA ascii or binary; pcl_convert_pcd_ascii_binary writes them");
      break;
    }
    if (!right) return WrongHead(*bytes, line, "numbers, one for each of FIELDS where there are some");
  }
  const bool small = width == 0 || height <= kMostPoints / width;
  head.points = points >= 0 ? points : small ? width * height : kMostPoints;
  return head;
}

class CloudReader : public ScanReader {
 public:
  CloudReader(const ScanFormat& format, CloudBytes bytes) : format_(format), bytes_(std::move(bytes)) {
    if (format.lines) std::tie(first_, last_) = *format.lines;
  }
  int64_t bytes_read() const override { return bytes_.bytes_read(); }
  int64_t bytes_total() const override { return bytes_.bytes_total(); }
  std::string Describe() const override { return description_; }

  Result<void> ReadHeader(bool ply) {
    SCANCAL_ASSIGN_OR_RETURN(head_, ply ? ReadPlyHead(&bytes_) : ReadPcdHead(&bytes_));
    size_t offset = 0;
    std::vector<std::string> names;
    for (const CloudField& field : head_.fields) {
      offset += (head_.ascii ? 1 : field.size) * field.count;
      if (field.type == 'F' && field.size < 4)
        return Error{bytes_.name() + ": found " + field.name + " as a fraction of " + std::to_string(field.size) +
                     " bytes, expected 4 or 8"};
      if (field.count == 1) names.push_back(field.name);
    }
    record_ = offset;
    if (record_ == 0 || record_ > kLongestCloudLine)
      return Error{bytes_.name() + ": found a header without columns, or of more than 1 MB a point"};
    SCANCAL_RETURN_IF_ERROR(Choose(names));
    description_ = bytes_.wrapping() + (bytes_.wrapping().empty() ? "" : ", ") + (ply ? "PLY" : "PCD") +
                   (head_.ascii ? ", ascii: " : ", binary: ");
    for (size_t k = 0; k < columns_.size(); ++k)
      description_ += (k > 0 ? ", " : "") + columns_[k].name +
                      (names[columns_[k].index] == columns_[k].name ? "" : " is its " + names[columns_[k].index]);
    if (head_.points == 0) return NoPoints(format_, 0);
    // From places among the columns of one number to places in the record.
    for (ChosenColumn& column : columns_) column.index = FieldOf(column.index);
    for (auto& [index, value] : where_) index = FieldOf(index);
    return {};
  }

  Result<bool> Next(ScanBatch* batch) override {
    batch->names.clear();
    for (const ChosenColumn& column : columns_) batch->names.push_back(column.name);
    batch->columns.resize(columns_.size());
    for (std::vector<double>& column : batch->columns) column.clear();
    while (batch->size() < kBatchPoints && point_ < std::min(head_.points, last_)) {
      SCANCAL_RETURN_IF_ERROR(ReadPoint());
      const auto is_not = [&](const auto& each) { return values_[each.first] != each.second; };
      if (point_ < first_ || std::any_of(where_.begin(), where_.end(), is_not)) continue;
      SCANCAL_RETURN_IF_ERROR(Give(batch));
    }
    if (point_ == head_.points && !head_.goes_on && !at_end_) {
      at_end_ = true;
      SCANCAL_ASSIGN_OR_RETURN(const char* const behind, bytes_.Record(2));  // a line end may follow
      if (behind && !WithoutBlanks(std::string_view(behind, 2)).empty() && *behind != '\n')
        return Error{bytes_.name() + ": found more behind the " + std::to_string(head_.points) +
                     " points that its head counts, expected the end of the file"};
    }
    any_point_ |= batch->size() > 0;
    if (!any_point_ && missing_ == 0) return NoPoints(format_, head_.points);
    return batch->size() > 0;
  }

 private:
  size_t FieldOf(size_t among_single) const {
    for (size_t k = 0; k < head_.fields.size(); ++k)
      if (head_.fields[k].count == 1 && among_single-- == 0) return k;
    return 0;
  }

  Result<void> Choose(const std::vector<std::string>& names) {
    const std::string place = bytes_.name() + ": head";
    ScanFormat only = format_;
    only.one_of.clear();
    std::erase_if(only.columns, [](const ScanColumn& column) {
      return (column.name != "angle" && column.name != "profile") || !column.required;
    });
    if (!only.columns.empty() && !ChooseColumns(only, names, place).ok())
      return Error{bytes_.name() + ": found a cloud of " + Listed(names) + " without the " + only.columns[0].name +
                   " of each point: it is registered already, with the angles and offsets that are looked for here; " +
                   "export the points as the sensor saw them, and name the column: columns: {" + only.columns[0].name +
                   ": ...}"};
    const auto is_x = [](const std::string& name) { return name == "x" || name == "X"; };
    const bool said = format_.names.contains("y") && format_.names.contains("z");
    const bool wanted = !format_.one_of.empty();  // a scan: of points with x, y, z all is said
    if (wanted && !said && std::any_of(names.begin(), names.end(), is_x))
      return Error{
          bytes_.name() + ": found a cloud of " + Listed(names) +
          ", expected which is the depth and which runs along the line: columns: {y: z, z: x}, or what they are"};
    SCANCAL_ASSIGN_OR_RETURN(columns_, ChooseColumns(format_, names, place));
    for (const auto& [name, value] : format_.text.where) {
      only.columns = {{name, Dimension::kNone}};
      SCANCAL_ASSIGN_OR_RETURN(const auto column, ChooseColumns(only, names, place + ": where"));
      const ParsedNumber number = ParseNumber(value);
      if (number.kind != NumberKind::kNumber)
        return Error{place + ": where: " + name + ": found " + Quoted(value) + ", expected a number"};
      where_.emplace_back(column[0].index, number.value);
    }
    return {};
  }

  // The next one, into values_.
  Result<void> ReadPoint() {
    values_.resize(head_.fields.size());
    if (head_.ascii) return ReadLine();
    SCANCAL_ASSIGN_OR_RETURN(const char* at, bytes_.Record(record_));
    if (at == nullptr) return CutOff();
    for (size_t k = 0; k < head_.fields.size(); ++k) {
      const CloudField& field = head_.fields[k];
      if (field.count == 1) values_[k] = NumberAt(at, field);
      at += field.size * field.count;
    }
    ++point_;
    return {};
  }

  Result<void> ReadLine() {
    std::string_view line;
    while (line.empty()) {
      SCANCAL_ASSIGN_OR_RETURN(const auto taken, bytes_.Line());
      if (!taken) return CutOff();
      line = WithoutBlanks(*taken);
    }
    ++point_;
    size_t found = 0;
    for (size_t k = 0; k < head_.fields.size(); ++k)
      for (size_t i = 0; i < head_.fields[k].count; ++i, ++found) {
        const size_t end = std::min(line.find_first_of(" \t"), line.size());
        const ParsedNumber number = ParseNumber(line.substr(0, end));
        const bool missing = number.kind == NumberKind::kMissing && end > 0;
        if (number.kind != NumberKind::kNumber && !missing)
          return Error{bytes_.name() + ":" + std::to_string(bytes_.line()) + ": " + head_.fields[k].name + ": found " +
                       Quoted(line.substr(0, end)) +
                       (end == 0 ? ", expected " + std::to_string(record_) + " numbers" : Expectation(number.kind))};
        values_[k] = missing ? std::numeric_limits<double>::quiet_NaN() : number.value;
        line = WithoutBlanks(line.substr(end));
      }
    if (line.empty()) return {};
    return Error{bytes_.name() + ":" + std::to_string(bytes_.line()) + ": found more than " + std::to_string(record_) +
                 " numbers, expected as many as the header has columns"};
  }

  Result<void> CutOff() const {
    return Error{bytes_.name() + ": found " + std::to_string(point_) + " points, expected " +
                 std::to_string(head_.points) + " as its header says; the file is probably cut off"};
  }

  template <class Number>
  static double As(const char* at) {
    Number number = 0;
    std::memcpy(&number, at, sizeof number);
    return static_cast<double>(number);
  }
  static double NumberAt(const char* at, const CloudField& field) {
    if (field.type == 'F') return field.size == 4 ? As<float>(at) : As<double>(at);
    const bool is_signed = field.type == 'I';
    if (field.size == 1) return is_signed ? As<int8_t>(at) : As<uint8_t>(at);
    if (field.size == 2) return is_signed ? As<int16_t>(at) : As<uint16_t>(at);
    if (field.size == 4) return is_signed ? As<int32_t>(at) : As<uint32_t>(at);
    return is_signed ? As<int64_t>(at) : As<uint64_t>(at);
  }

  Result<void> Give(ScanBatch* batch) {
    bool missing = false;
    for (const ChosenColumn& column : columns_) {
      const double number = values_[column.index];
      if (std::isinf(number))
        return Error{bytes_.name() + ": point " + std::to_string(point_) + ": " + column.name + ": found " +
                     (number > 0 ? "inf" : "-inf") + Expectation(NumberKind::kInfinite)};
      const std::vector<double>& more = format_.more_invalid;
      missing |= std::isnan(number) || number == format_.invalid || std::count(more.begin(), more.end(), number) > 0;
    }
    if (missing) {
      ++missing_;
      return {};
    }
    for (size_t k = 0; k < columns_.size(); ++k)
      batch->columns[k].push_back(values_[columns_[k].index] * columns_[k].factor);
    return {};
  }

  const ScanFormat format_;
  CloudBytes bytes_;
  CloudHead head_;
  size_t record_ = 0;  // bytes of a point; ascii: numbers
  std::vector<ChosenColumn> columns_;
  std::vector<std::pair<size_t, double>> where_;
  std::vector<double> values_;  // of the point in hand, one for each field
  int64_t first_ = 1, last_ = std::numeric_limits<int64_t>::max(), point_ = 0;
  bool any_point_ = false, at_end_ = false;
  std::string description_;
};

template <bool kIsPly>
Result<std::unique_ptr<ScanReader>> OpenCloud(const ScanFormat& format) {
  SCANCAL_ASSIGN_OR_RETURN(DecodedFile file, DecodedFile::Open(format.path));
  auto reader = std::make_unique<CloudReader>(format, CloudBytes(std::move(file)));
  SCANCAL_RETURN_IF_ERROR(reader->ReadHeader(kIsPly));
  return std::unique_ptr<ScanReader>(std::move(reader));
}

bool IsPly(std::string_view start, const ScanFormat& /*format*/) {
  return start.starts_with("ply\n") || start.starts_with("ply\r\n");
}

bool IsPcd(std::string_view start, const ScanFormat& /*format*/) {
  if (start.starts_with("# .PCD v")) return true;
  while (start.starts_with('#')) TakeFirstLine(&start);
  return start.starts_with("VERSION ") && start.substr(0, 1000).find("\nFIELDS ") != std::string_view::npos;
}

}  // namespace

const FileKind kPly = {"ply", "PLY", &IsPly, &OpenCloud<true>};
const FileKind kPcd = {"pcd", "PCD", &IsPcd, &OpenCloud<false>};

}  // namespace scancal
