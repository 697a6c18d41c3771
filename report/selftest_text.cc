#include <fmt/format.h>
#include <cmath>
#include "report/text.h"
#include "report/text_table.h"

namespace scancal {
namespace {

std::string OneDecimal(double digits) { return fmt::format("{:.1f}", std::floor(10 * digits) / 10); }  // never up

std::string CountOrNone(int count) { return count > 0 ? std::to_string(count) : "-"; }

}  // namespace

std::string ToText(const Selftest& selftest) {
  TextTable table({"case", "difficulty", "observations", "parameters", "digits", "required", "digits of u", "required",
                   "iterations", ""});
  std::string notes;
  size_t passed = 0;
  for (const SelftestRow& row : selftest.rows) {
    table.Add({row.name, row.level.empty() ? "-" : row.level, CountOrNone(row.observations),
               CountOrNone(row.parameters), OneDecimal(row.values.reached), OneDecimal(row.values.required),
               OneDecimal(row.deviations.reached), OneDecimal(row.deviations.required), CountOrNone(row.iterations),
               row.pass() ? "pass" : "FAIL"});
    if (!row.note.empty()) notes += row.name + ": " + row.note + "\n";
    passed += row.pass();
  }
  return table.Text() +
         "digits: -log10 of the relative error of the estimate, and of the standard uncertainty u, nearest to failing\n"
         "GUM: published results, to one unit of their last digit\n" +
         notes +
         fmt::format("\n{} of {} cases passed\nselftest: {}\n", passed, selftest.rows.size(),
                     selftest.ok() ? "pass" : "FAIL");
}

}  // namespace scancal
