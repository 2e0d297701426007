#pragma once
#include <map>
#include <string>
#include <vector>

namespace rt::test {

/// {column: cell}
using CsvRow = std::map<std::string, std::string>;

/// The rows of a file whose first line names the columns; cells may be in quotes. Throws
/// std::runtime_error for a row of another number of cells.
std::vector<CsvRow> readCsv(const std::string& path);

} // namespace rt::test
