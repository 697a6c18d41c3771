// Scan files, read in batches of points with named columns in mm and rad.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include "io/dialect.h"
#include "io/number.h"
#include "io/result.h"
#include "io/units.h"
#include "io/yaml.h"

namespace scancal {

class DecodedFile;

struct ScanColumn {
  std::string name;  // "angle", "y"
  Dimension dimension = Dimension::kNone;
  bool required = true;     // optional ones are absent from the batch if the file has none
  std::string remedy = {};  // behind the complaint that a required one is missing: "; ..."
};

struct WideLayout {              // one profile per line; tall: one per column
  std::string value;             // what the cells hold: "y" | "range"
  std::string across;            // what runs along the line: "z" (with y) | "bearing" (with range)
  int angle_column = 1;          // 1-based
  int first_column = 2;          // first cell, 1-based
  double start = 0, step = 1;    // of `across`, declared unit
  bool tall = false;             // angle_column has `across` instead, and angles come from LoggedAngle
  double scale = 1, offset = 0;  // a cell's number times this and plus that is in the declared unit
  bool image = false;            // cells alone, a profile a row
  bool scaled = false;           // `scale` was declared
  bool heights = false;          // the maker of the instrument counts y towards the sensor
  std::string echo = {};         // what is to be said of it
  bool HasNoAngles() const { return tall || angle_column == 0; }
};

// How a file says the angle of a profile where no column has it.
struct LoggedAngle {
  std::string column = "angle";      // counts, or a time
  double rad_per_count = 1;          // or per unit of time; is_step: from one profile to the next
  double zero = 0;                   // the count at angle 0
  double wrap = 0;                   // counts after which the counter starts again; 0: it does not
  bool is_step = false;              // no column: the first profile is at `start`, the others follow by their number
  double start = 0;                  // rad
  std::filesystem::path file = {};   // of its own, with `column` and `by`; empty: the scan's
  std::string by = {};               // the column that both files have: a time stamp or a frame number
  std::optional<double> first = {};  // the number of the profile at `start`; none: the first in the file
  std::string echo = {};             // what was declared, in words
};

// Of a bag of ROS messages: what the data set names; empty: the only one there is.
struct RosNames {
  std::string topic;                    // of the scans
  std::string joint, joint_topic = {};  // whose position is the angle, and where it is told
};

struct ScanFormat {  // how one scan file is to be read, as the data set declares it
  std::filesystem::path path;
  std::string kind;                              // a FileKind's name; empty: told from the content
  Units units;                                   // a unit suffix of a column's name (angle_deg, y_mm) wins
  std::vector<ScanColumn> columns;               // wanted; others in the file are ignored
  std::vector<std::vector<std::string>> one_of;  // of these groups the file needs one whole; empty: any will do
  std::vector<std::string> npy_columns;          // names of the columns of a .npy, or of a text without names
  std::map<std::string, std::string> names;      // what the file calls a wanted column: {"angle", "Encoder"}
  std::optional<LoggedAngle> angle;              // in place of a column with angles
  bool wants_angles_from_steps = false;          // set by OpenLogged, of the file behind it
  TextFormat text;                               // of text: what is declared of its dialect
  std::optional<double> invalid;                 // this value, as it stands in the file, is a missing point
  std::vector<double> more_invalid;              // and these
  std::optional<WideLayout> layout;
  RosNames ros;
  std::optional<std::pair<int64_t, int64_t>>
      lines;  // keep only these lines of the file (rows of a .npy), 1-based, inclusive
};

struct ScanBatch {                           // equally long columns, in the order of `names`
  std::vector<std::string> names;            // the columns found; wide files add "profile" (the line's number)
  std::vector<std::vector<double>> columns;  // mm, rad; of dimension kNone as in the file
  size_t size() const { return columns.empty() ? 0 : columns.front().size(); }
  int Find(std::string_view name) const;  // index, or -1
};

// What a data set, or a target of its own, says of its files: `format`, `columns`, `angle`, `invalid`, `text`, `where`;
// of bags `topic`, `joint`, `joint_topic`.
// folder: where a file of angles counts from.
void ReadFormat(YamlMap map, const std::filesystem::path& folder, ScanFormat* format);
// Of them those that a table of few lines has as well: `columns`; `text` and `where`.
void ReadColumnNames(YamlMap map, ScanFormat* format);
void ReadTextFormat(YamlMap map, ScanFormat* format);

// Delimited text in any dialect (FindHead), the same with a profile a line (layout), .npy (float64 | float32, C order,
// shape (points, columns)), what instruments write (FindFileKind); by content, layout, then extension. Missing points
// (empty, nan, `invalid` in a wanted column) are left out and counted. inf, text, overflow, a wrong number of fields
// are errors: "left.csv:1042:8: y: found "12.3.4", expected a number".
class ScanReader {
 public:
  static Result<std::unique_ptr<ScanReader>> Open(const ScanFormat& format);
  virtual ~ScanReader() = default;
  // Some thousand points; false, and none, at the end of the file.
  virtual Result<bool> Next(ScanBatch* batch) = 0;
  virtual int64_t bytes_read() const = 0;  // so far, for a progress bar
  virtual int64_t bytes_total() const = 0;
  // Of the first profile in the file, with points or without; none: it cannot be told.
  virtual std::optional<double> FirstProfile() const { return std::nullopt; }
  virtual std::string Describe() const { return ""; }  // what was found of the file's dialect; empty: a plain file
  // y grows towards the sensor, as the maker of the instrument says: which way it grows is to be declared.
  virtual bool gives_heights() const { return false; }
  int64_t missing() const { return missing_; }  // so far

 protected:
  static constexpr size_t kBatchPoints = 8192;  // stays in the cache
  int64_t missing_ = 0;
};

// The formats, each of its own; ScanReader::Open chooses.
Result<std::unique_ptr<ScanReader>> OpenCsv(const ScanFormat& format, DecodedFile file);
Result<std::unique_ptr<ScanReader>> OpenWideCsv(const ScanFormat& format);
Result<std::unique_ptr<ScanReader>> OpenNpy(const ScanFormat& format, DecodedFile file);
// Any of them, with the angles of format.angle.
Result<std::unique_ptr<ScanReader>> OpenLogged(const ScanFormat& format);
// Of a file that has profiles without angles: whether they are joined by the number of the profile (else they come from
// steps); neither is an error.
Result<bool> AnglesByProfile(const ScanFormat& format);
LoggedAngle ReadLoggedAngle(YamlMap map, const std::filesystem::path& folder,
                            const Units& units);  // {column: Encoder, counts_per_turn: 36000, zero: 1200}

struct ChosenColumn {
  std::string name;   // as wanted: "y"
  size_t index = 0;   // in the file, 0-based
  double factor = 1;  // times this: mm, rad
};

// The wanted columns that the file has, in the order of format.columns. `place`: of the header, for complaints:
// "left.csv:1". A required one that is missing, or one that is there twice ("y" and "y_mm"): an error.
// Names are told apart by case only where both are there ("y_mm", "Y_mm"). units: of the columns, from a row of their
// own; empty: none.
Result<std::vector<ChosenColumn>> ChooseColumns(const ScanFormat& format, const std::vector<std::string>& found,
                                                const std::string& place, const std::vector<std::string>& units = {});

// The columns of format.text.where in a file with these names, and their values.
Result<std::vector<std::pair<size_t, std::string>>> ChooseWhere(const ScanFormat& format,
                                                                const std::vector<std::string>& found,
                                                                const std::string& place);

// The unit of `wanted` if `found` is its name, plain ("y", in which case it is that of its own row, or the declared
// one) or with a unit ("y_mm", "Y [mm]", "y (um)", "z/mm"); else empty.
std::optional<double> MatchColumn(const ScanColumn& wanted, std::string_view found, const Units& units,
                                  std::string_view own_unit = {});

// "left.csv: no points": the file has none, or the wanted lines or rows have none. first_unwanted: what a row that
// `where` leaves out has in its columns.
Error NoPoints(const ScanFormat& format, int64_t lines_in_file, const std::string& first_unwanted = {});

}  // namespace scancal
