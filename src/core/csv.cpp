#include "perennial/core/csv.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>

#include "perennial/core/error.h"

namespace perennial {
namespace {

std::string at(const std::string& file, std::size_t line) { return file + ":" + std::to_string(line) + ": "; }

/// None when a quote is not closed.
std::optional<std::vector<std::string>> split(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (c == '"' && (quoted || fields.back().empty())) {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return quoted ? std::nullopt : std::make_optional(fields);
}

void removeByteOrderMark(std::string& line) {
  if (line.compare(0, 3, "\xEF\xBB\xBF") == 0) {
    line.erase(0, 3);
  }
}

}  // namespace

CsvTable CsvTable::load(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) {
    throw DatasetError(file + ": cannot be opened; is it there and readable?");
  }
  return parse(stream, file);
}

CsvTable CsvTable::parse(std::istream& content, const std::string& file) {
  CsvTable table;
  table.file_ = file;
  std::string line;
  for (std::size_t number = 1; std::getline(content, line); ++number) {
    if (number == 1) {
      removeByteOrderMark(line);
    }
    if (!line.empty() && line.back() == '\r') {
      line.pop_back();
    }
    if (line.empty()) {
      continue;
    }
    const auto fields = split(line);
    if (!fields) {
      throw DatasetError(at(file, number) + "a quote is not closed");
    }
    if (!table.columns_.empty()) {
      table.rows_.push_back({number, *fields});
      if (fields->size() != table.columns_.size()) {
        table.fail(table.rows_.back(), "has " + std::to_string(fields->size()) +
                                           " fields, but the header has " +
                                           std::to_string(table.columns_.size()));
      }
      continue;
    }
    for (const std::string& column : *fields) {
      if (!table.columns_.emplace(column, table.columns_.size()).second) {
        throw DatasetError(at(file, number) + "the column '" + column + "' stands there twice");
      }
    }
  }
  if (table.columns_.empty()) {
    throw DatasetError(file + ": is empty, there is no header");
  }
  return table;
}

const std::string& CsvTable::text(const CsvRow& row, const std::string& column) const {
  const auto found = columns_.find(column);
  if (found == columns_.end()) {
    std::string known;
    for (const auto& entry : columns_) {
      known += (known.empty() ? "" : ", ") + entry.first;
    }
    throw DatasetError(at(file_, 1) + "there is no column '" + column + "', only: " + known);
  }
  return row.fields[found->second];
}

double CsvTable::number(const CsvRow& row, const std::string& column) const {
  const std::string& field = text(row, column);
  char* end = nullptr;
  const double value = std::strtod(field.c_str(), &end);
  if (field.empty() || *end != '\0' || !std::isfinite(value)) {
    fail(row, "'" + field + "' in column '" + column + "' is not a number");
  }
  return value;
}

void CsvTable::fail(const CsvRow& row, const std::string& problem) const {
  throw DatasetError(at(file_, row.line) + problem);
}

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + "\"";
}

}  // namespace perennial
