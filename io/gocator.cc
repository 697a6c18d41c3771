// CSV that LMI's Gocators export: sections from a line with their name to a line "End" (Gocator Line Profile Sensors,
// User Manual, "CSV File Format"). Read are
//
//     Profile     a row a profile: Frame,Source,Time,Encoder,...,Axis,  then Z at the positions X in the header
//     RawProfile  rows X and Z of each frame
//     Part        a table of Z: the positions X in its first row, Y in its first column
//
// the first of them in the file. Its X runs along the line, z here; its Z, a height in mm, is y here, as it stands
// there: it grows towards the sensor (`depth: towards`).
#include <map>
#include "io/file_kind.h"
#include "io/message.h"
#include "io/scan_csv.h"

namespace scancal {
namespace {

constexpr double kLeastRange = -1e300;  // what is missing is the least double there

// Names of sections are a cell alone, in files that a table editor wrote again with empty cells behind it.
std::vector<std::string> SectionCells(std::string_view row) {
  std::vector<std::string> cells = SplitCells(row);
  while (cells.size() > 1 && cells.back().empty()) cells.pop_back();
  return cells;
}

bool IsSection(const std::vector<std::string>& cells) {
  static const std::vector<std::string> kSections = {
      "Info",    "DeviceInfo",        "RecordingFilter", "Range",   "Ranges",     "Surface Section",
      "Surface", "SurfacePointCloud", "SurfaceSection",  "Profile", "RawProfile", "Part"};
  return cells.size() == 1 && std::find(kSections.begin(), kSections.end(), cells[0]) != kSections.end();
}

bool IsGocator(std::string_view start, const ScanFormat& format) {
  if (format.layout || !format.npy_columns.empty()) return false;
  std::string_view first;
  while (!start.empty() && first.empty()) first = WithoutBlanks(TakeFirstLine(&start));
  if (!IsSection(SectionCells(first))) return false;
  const std::vector<std::string> names = SectionCells(TakeFirstLine(&start));
  return names.size() > 1 && ParseNumber(names[0]).kind == NumberKind::kText;
}

size_t IndexOf(const std::vector<std::string>& names, std::string_view name) {
  return static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

class GocatorReader : public CsvReader {
 public:
  using CsvReader::CsvReader;
  std::optional<double> FirstProfile() const override { return first_profile_; }
  bool gives_heights() const override { return true; }
  std::string Describe() const override {
    const std::string text = CsvReader::Describe();
    return text + (text.empty() ? "" : ", ") + "Gocator CSV, " + section_ + " in line " +
           std::to_string(section_line_) + ": y is its Z and z its X, in mm" + positions_;
  }

  Result<void> ReadHeader() {
    SCANCAL_RETURN_IF_ERROR(FindSection());
    SCANCAL_RETURN_IF_ERROR(ReadNames());
    SCANCAL_RETURN_IF_ERROR(ReadPositions());
    std::vector<ExpectedCells> cells(values_ + 1);
    for (const ChosenColumn& column : columns_) cells[column.index] = {Cells::kNumberOrNothing, header_[column.index]};
    cells[values_] = {Cells::kNumberOrNothing, raw_ ? "X or Z" : "Z"};
    text_.Expect(std::move(cells), {}, CellCount::kAny);
    text_.TreatAsMissing(format_.text.missing);
    KeepLines();
    return {};
  }

  Result<bool> Next(ScanBatch* batch) override {
    batch->names.clear();
    for (const ChosenColumn& column : columns_) batch->names.push_back(column.name);
    for (const char* name : {"z", "y", "profile"}) batch->names.emplace_back(name);
    batch->columns.resize(batch->names.size());
    for (std::vector<double>& column : batch->columns) column.clear();
    while (batch->size() < kBatchPoints) {
      SCANCAL_ASSIGN_OR_RETURN(const std::string_view row, text_.Peek());
      if (row.empty() || WithoutBlanks(row.substr(0, row.find(','))) == "End") {
        SCANCAL_RETURN_IF_ERROR(CheckEnd(row.empty()));
        break;
      }
      SCANCAL_RETURN_IF_ERROR(TakeRow(row, batch));
    }
    return Taken(batch->size());
  }

 private:
  // Up to the row of names above the data.
  Result<void> FindSection() {
    std::vector<std::string> found, info;
    for (std::string section;;) {
      SCANCAL_ASSIGN_OR_RETURN(const std::string_view row, text_.Peek());
      if (row.empty()) break;
      const std::vector<std::string> cells = SectionCells(row);
      text_.Skip();
      if (cells[0] == "End") {
        section.clear();
      } else if (IsSection(cells) && section != "RecordingFilter") {
        section = cells[0];
        found.push_back(section);
        info.clear();
        raw_ = section == "RawProfile";
        part_ = section == "Part" || section == "Surface";
        section_line_ = text_.line();
      } else if (section == "Info" && info.empty()) {
        info = cells;
      } else if (section == "Info") {
        Remember(info, cells);
      } else if (raw_ || part_ || section == "Profile") {
        section_ = section;
        return ReadAttributes(cells);
      }
    }
    return Error{text_.name() + ": found " +
                 (found.empty() ? "none of the sections" : "the sections " + Listed(found)) +
                 " of a Gocator's CSV, expected Profile, RawProfile or Part; export profiles or a surface"};
  }

  void Remember(const std::vector<std::string>& names, const std::vector<std::string>& values) {
    for (size_t k = 0; k < std::min(names.size(), values.size()); ++k)
      if (const ParsedNumber number = ParseNumber(values[k]); number.kind == NumberKind::kNumber)
        attributes_[names[k]] = number.value;
  }

  Result<void> ReadAttributes(const std::vector<std::string>& names) {
    if (std::find(names.begin(), names.end(), "Column Count") == names.end())
      return Error{text_.Place() + ": found " + Listed(names) + " below " + section_ +
                   ", expected its attributes: " + "Frame Count, Column Count, X Offset, ..." + text_.WrongSeparator()};
    SCANCAL_ASSIGN_OR_RETURN(const std::string_view row, text_.Peek());
    Remember(names, SectionCells(row));
    if (!row.empty()) text_.Skip();
    return {};
  }

  Result<void> ReadNames() {
    SCANCAL_ASSIGN_OR_RETURN(const std::string_view row, text_.Peek());
    header_ = SectionCells(row);
    const size_t axis = IndexOf(header_, "Axis");
    if (part_ ? header_[0] != "Y\\X" && !header_[0].empty() : axis == header_.size() || header_[0] != "Frame")
      return Error{text_.name() + ":" + std::to_string(text_.line() + 1) + ": found " + Listed(SectionCells(row)) +
                   ", expected the header of the data of " + section_ + ": " +
                   (part_ ? "Y\\X and the positions X" : "Frame, ..., Axis and the positions X")};
    if (!row.empty()) text_.Skip();
    values_ = part_ ? 1 : axis + 1;
    source_ = IndexOf(header_, "Source");
    std::vector<std::string> names =
        part_ ? std::vector<std::string>{"Y"}
              : std::vector<std::string>(header_.begin(), header_.begin() + static_cast<std::ptrdiff_t>(axis));
    ScanFormat rows = format_;
    rows.one_of.clear();
    std::erase_if(rows.columns, [](const ScanColumn& column) {
      return column.name == "y" || column.name == "z" || column.name == "bearing" || column.name == "range" ||
             column.name == "profile";
    });
    for (ScanColumn& column : rows.columns)
      if (column.name == "angle")
        column.remedy = part_ ? "; a surface has no angles: say angle: {start: ..., step: ...}, from row to row"
                              : "; say which has it: angle: {column: Encoder, counts_per_turn: ...}";
    rows.columns.push_back({names[0], Dimension::kNone});  // there is always one
    SCANCAL_ASSIGN_OR_RETURN(columns_, ChooseColumns(rows, names, text_.Place()));
    columns_.pop_back();
    SCANCAL_ASSIGN_OR_RETURN(where_, ChooseWhere(format_, names, text_.Place()));
    return {};
  }

  // X of each column, where the header has it.
  Result<void> ReadPositions() {
    std::string notes;
    const auto offset = [&](const char* name) {
      const auto found = attributes_.find(name);
      return found == attributes_.end() ? 0.0 : found->second;
    };
    const auto note = [&](const char* name) {
      if (offset(name) != 0) notes += std::string(", ") + name + " " + Plainly(offset(name)) + " not added";
    };
    cells_ = header_.size() - values_;
    if (cells_ == 0) return Error{text_.Place() + ": found no columns of values, expected one a position X"};
    for (size_t k = 0; k < cells_ && !raw_; ++k) {
      const ParsedNumber number = ParseNumber(header_[values_ + k]);
      if (number.kind != NumberKind::kNumber)
        return Error{text_.Place() + ": found " + Quoted(header_[values_ + k]) + " among the positions X" +
                     Expectation(number.kind)};
      x_.push_back(number.value);
    }
    bool counts = !raw_ && cells_ > 1;
    for (size_t k = 1; k < cells_ && counts; ++k) counts = x_[k] == x_[0] + static_cast<double>(k) && x_[0] <= 1;
    const double resolution = attributes_.contains("X Resolution") ? offset("X Resolution") : offset("XResolution");
    counts &= (x_.empty() || x_[0] == 0 || x_[0] == 1) && resolution != 1;
    if (counts && !(resolution > 0))
      return Error{text_.Place() + ": found columns that are counted, " + Plainly(x_[0]) + " to " + Plainly(x_.back()) +
                   ", and no X Resolution, expected their positions X"};
    if (counts) {
      for (size_t k = 0; k < cells_; ++k) x_[k] = offset("X Offset") + resolution * static_cast<double>(k);
      notes = ", X from X Offset " + Plainly(offset("X Offset")) + " and the resolution " + Plainly(resolution);
    } else if (raw_ || std::abs(x_[0] - offset("X Offset")) > (cells_ > 1 ? std::abs(x_[1] - x_[0]) : 0)) {
      note("X Offset");
    }
    note("Z Offset");
    positions_ = notes;
    return {};
  }

  Error Cut() const {
    return {text_.name() + ": found no row End behind " + section_ + " in line " + std::to_string(section_line_) +
            ", expected one; the file is probably cut off"};
  }

  Result<void> CheckEnd(bool at_end_of_file) {
    if (at_end_of_file && !format_.lines) return Cut();
    if (pending_x_ || pending_z_) return Unpaired();
    return {};
  }

  Error Unpaired() const {
    return {text_.name() + ": found frame " + Plainly(frame_) + " with a row of Axis " + (pending_x_ ? "X" : "Z") +
            " alone, expected one of X and one of Z"};
  }

  // Whether it is wanted, and what is special of its first cells.
  Result<void> TakeRow(std::string_view row, ScanBatch* batch) {
    size_t end = 0;
    for (size_t k = 0; k < values_ && end != std::string_view::npos; ++k) end = row.find(',', end + (k > 0 ? 1 : 0));
    const std::vector<std::string> first = SplitCells(row.substr(0, end));
    const auto unwanted = [&](const auto& each) {
      return each.first >= first.size() || !CellIs(first[each.first], each.second);
    };
    const std::string axis = part_ || first.size() < values_ ? "Z" : first[values_ - 1];
    if (std::any_of(where_.begin(), where_.end(), unwanted) || axis == "I") {
      text_.Skip();
      return {};
    }
    if (axis != "Z" && (axis != "X" || !raw_))
      return Error{text_.name() + ":" + std::to_string(text_.line() + 1) + ": Axis: found " + Quoted(axis) +
                   ", expected " + (raw_ ? "X, Z or I" : "Z or I")};
    if (!part_ && source_ < values_ && source_ < first.size()) SCANCAL_RETURN_IF_ERROR(CheckSource(first[source_]));
    const double frame = part_ ? frame_ + 1 : ParseNumber(first[0]).value;
    if ((pending_x_ || pending_z_) && frame != frame_) return Unpaired();
    frame_ = frame;
    if (!first_profile_) first_profile_ = frame;
    SCANCAL_RETURN_IF_ERROR(text_.Next());
    if (text_.cells() != values_ + cells_)
      return Error{text_.Place() + ": found " + std::to_string(text_.cells()) + " cells, expected " +
                   std::to_string(values_ + cells_) + " as in the header" +
                   (text_.cells() < values_ + cells_ ? text_.CutOff() : "")};
    if (!raw_) return Give(x_, nullptr, batch), Result<void>();
    if (axis == "X") {
      x_.clear();
      for (size_t k = 0; k < cells_; ++k) x_.push_back(text_.Number(values_ + k));
      pending_x_ = !std::exchange(pending_z_, false);
      if (!pending_x_) Give(x_, &z_, batch);
    } else if (std::exchange(pending_x_, false)) {
      Give(x_, nullptr, batch);
    } else {
      z_.clear();
      for (size_t k = 0; k < cells_; ++k) z_.push_back(text_.Number(values_ + k));
      pending_z_ = true;
    }
    return {};
  }

  Result<void> CheckSource(const std::string& source) {
    if (!seen_source_) seen_source_ = source;
    if (*seen_source_ == source) return {};
    return Error{text_.name() + ":" + std::to_string(text_.line() + 1) + ": found the sources " + *seen_source_ +
                 " and " + source + ", which are two sensors; say which: where: {Source: " + *seen_source_ + "}"};
  }

  // heights: of the row in hand, or of the one before.
  void Give(const std::vector<double>& x, const std::vector<double>* heights, ScanBatch* batch) {
    std::vector<double> of_row;
    bool no_row = false;
    for (const ChosenColumn& column : columns_) {
      of_row.push_back(text_.Number(column.index) * column.factor);
      no_row |= std::isnan(of_row.back());
    }
    for (size_t k = 0; k < cells_; ++k) {
      const double height = heights ? (*heights)[k] : text_.Number(values_ + k);
      if (no_row || IsMissing(height) || IsMissing(x[k]) || height < kLeastRange || x[k] < kLeastRange) {
        ++missing_;
        continue;
      }
      for (size_t c = 0; c < of_row.size(); ++c) batch->columns[c].push_back(of_row[c]);
      batch->columns[of_row.size()].push_back(x[k]);
      batch->columns[of_row.size() + 1].push_back(height);
      batch->columns[of_row.size() + 2].push_back(frame_);
    }
  }

  std::string section_, positions_;
  int64_t section_line_ = 0;
  bool raw_ = false, part_ = false;
  std::map<std::string, double> attributes_;  // of Info and of the section
  std::vector<std::string> header_;
  size_t values_ = 0, cells_ = 0;  // the first column of values; their number
  size_t source_ = 0;              // its column
  std::vector<ChosenColumn> columns_;
  std::vector<std::pair<size_t, std::string>> where_;
  std::vector<double> x_, z_;
  bool pending_x_ = false, pending_z_ = false;  // of frame_, whose other row is still to come
  double frame_ = 0;
  std::optional<double> first_profile_;
  std::optional<std::string> seen_source_;
};

Result<std::unique_ptr<ScanReader>> OpenGocator(const ScanFormat& format) {
  return OpenText<GocatorReader>(format, DelimitedText::Open(format.path));
}

}  // namespace

const FileKind kGocator = {"gocator", "Gocator CSV", &IsGocator, &OpenGocator};

}  // namespace scancal
