#pragma once

#include <cstddef>
#include <istream>
#include <map>
#include <string>
#include <vector>

namespace perennial {

/// One line of a CSV table.
struct CsvRow {
  std::size_t line = 0;  ///< of the file, from 1
  std::vector<std::string> fields;
};

/// A table with a header, read whole: commas, fields quoted with "" where they hold commas or quotes (RFC
/// 4180, but no line breaks inside of fields), LF or CRLF, an optional UTF-8 byte order mark; empty lines are
/// skipped.
class CsvTable {
 public:
  /// Throws DatasetError, naming file and line: no such file, no header, a column named twice, a row with
  /// another number of fields than the header, an unfinished quote.
  static CsvTable load(const std::string& file);
  /// The same from the content of the file, which is named in messages.
  static CsvTable parse(std::istream& content, const std::string& file);

  const std::string& file() const { return file_; }
  const std::vector<CsvRow>& rows() const { return rows_; }

  bool hasColumn(const std::string& column) const { return columns_.count(column) > 0; }

  /// The field of a row. Throws DatasetError naming the file, the missing column and those there are.
  const std::string& text(const CsvRow& row, const std::string& column) const;
  /// The field as a finite number. Throws DatasetError naming file, line and column.
  double number(const CsvRow& row, const std::string& column) const;

  /// Throws a DatasetError of "FILE:LINE: problem".
  [[noreturn]] void fail(const CsvRow& row, const std::string& problem) const;

 private:
  std::string file_;
  std::map<std::string, std::size_t> columns_;
  std::vector<CsvRow> rows_;
};

/// Quotes a field where it needs it.
std::string csvField(const std::string& text);

}  // namespace perennial
