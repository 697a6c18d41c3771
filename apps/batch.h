// scancal refine --batch: many data sets, a program for each.
#pragma once
#include <string>

namespace scancal {

// Refines every data set of `list`, a text file with one a line (-: standard input), that of line L into `folder`/L,
// by this program again as `refine DATASET --out=... --accept_unreliable --resume` with the flags that were
// given: one that fails or crashes stops no other. threads: so many at a time; 0: one for every core. Prints a line as
// each ends and a table; writes summary.csv and summary.json. SIGINT, SIGTERM and SIGHUP end it with a summary of what
// is done. Returns the exit code: 0 where all were computed.
int RefineBatch(const std::string& list, const std::string& folder, int threads);

}  // namespace scancal
