#include "apps/load.h"
#include <cstdio>

namespace scancal {

Result<Dataset> ReadOnlyArgument(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1)
    return Error{"found " + std::to_string(arguments.size()) + " arguments, expected one: the folder of a data set"};
  return ReadDataset(arguments[0]);
}

Result<std::unique_ptr<Scanner>> LoadAndEcho(const std::vector<std::string>& arguments) {
  SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset, ReadOnlyArgument(arguments));
  SCANCAL_ASSIGN_OR_RETURN(const ScannerKind* kind, FindScannerKind(dataset));
  SCANCAL_ASSIGN_OR_RETURN(std::unique_ptr<Scanner> scanner, kind->load(dataset));
  std::printf("%s\n\n", scanner->Describe().c_str());
  return scanner;
}

}  // namespace scancal
