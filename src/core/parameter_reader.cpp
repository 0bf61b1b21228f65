#include "perennial/core/parameter_reader.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "perennial/core/error.h"

namespace perennial {
namespace {

template <typename Container>
std::string joined(const Container& words) {
  std::string text;
  for (const std::string& word : words) {
    text += (text.empty() ? "" : ", ") + word;
  }
  return text.empty() ? "none" : text;
}

template <typename Number>
std::string range(Number minimum, Number maximum) {
  std::ostringstream text;
  text << "[" << minimum << ", " << maximum << "]";
  return text.str();
}

template <typename Number>
std::string outOfRange(Number value, Number minimum, Number maximum) {
  std::ostringstream text;
  text << "is " << value << ", outside of the range " << range(minimum, maximum);
  return text.str();
}

}  // namespace

ParameterReader::ParameterReader(Parameters values, std::string name_space)
    : values_(std::move(values)), name_space_(std::move(name_space)) {}

bool ParameterReader::boolean(const std::string& key, bool default_value) {
  const ParameterValue* value = find(key);
  if (value == nullptr) {
    return default_value;
  }
  if (!std::holds_alternative<bool>(*value)) {
    fail(key, "must be true or false");
  }
  return std::get<bool>(*value);
}

int ParameterReader::integer(const std::string& key, int default_value, int minimum, int maximum) {
  const ParameterValue* value = find(key);
  if (value == nullptr) {
    return default_value;
  }
  if (!std::holds_alternative<int>(*value)) {
    fail(key, "must be an integer in " + range(minimum, maximum));
  }
  const int number = std::get<int>(*value);
  if (number < minimum || number > maximum) {
    fail(key, outOfRange(number, minimum, maximum));
  }
  return number;
}

double ParameterReader::real(const std::string& key, double default_value, double minimum, double maximum) {
  const ParameterValue* value = find(key);
  if (value == nullptr) {
    return default_value;
  }
  double number = 0.0;
  if (std::holds_alternative<double>(*value)) {
    number = std::get<double>(*value);
  } else if (std::holds_alternative<int>(*value)) {
    number = std::get<int>(*value);
  } else {
    fail(key, "must be a number in " + range(minimum, maximum));
  }
  if (!(number >= minimum && number <= maximum)) {
    fail(key, outOfRange(number, minimum, maximum));
  }
  return number;
}

std::string ParameterReader::text(const std::string& key, const std::string& default_value) {
  const ParameterValue* value = find(key);
  if (value == nullptr) {
    return default_value;
  }
  if (!std::holds_alternative<std::string>(*value)) {
    fail(key, "must be a text");
  }
  return std::get<std::string>(*value);
}

std::string ParameterReader::choice(const std::string& key, const std::string& default_value,
                                    const std::vector<std::string>& allowed) {
  std::string value = text(key, default_value);
  if (std::find(allowed.begin(), allowed.end(), value) == allowed.end()) {
    fail(key, "is '" + value + "', but must be one of: " + joined(allowed));
  }
  return value;
}

std::vector<double> ParameterReader::reals(const std::string& key, const std::vector<double>& default_value,
                                           double minimum, double maximum) {
  const ParameterValue* value = find(key);
  if (value == nullptr) {
    return default_value;
  }
  if (!std::holds_alternative<std::vector<double>>(*value)) {
    fail(key, "must be a list of numbers, each in " + range(minimum, maximum));
  }
  const auto& numbers = std::get<std::vector<double>>(*value);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!(numbers[i] >= minimum && numbers[i] <= maximum)) {
      fail(key + "[" + std::to_string(i) + "]", outOfRange(numbers[i], minimum, maximum));
    }
  }
  return numbers;
}

void ParameterReader::requireAllUsed() const {
  for (const auto& [key, value] : values_) {
    if (known_keys_.count(key) == 0) {
      throw ParameterError("unknown parameter " + name_space_ + key +
                           "; the known ones are: " + joined(known_keys_));
    }
  }
}

const ParameterValue* ParameterReader::find(const std::string& key) {
  known_keys_.insert(key);
  const auto entry = values_.find(key);
  return entry == values_.end() ? nullptr : &entry->second;
}

void ParameterReader::fail(const std::string& key, const std::string& problem) const {
  throw ParameterError("parameter " + name_space_ + key + " " + problem);
}

}  // namespace perennial
