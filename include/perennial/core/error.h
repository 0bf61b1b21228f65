#pragma once

#include <stdexcept>
#include <string>

/// Exceptions of the core. The core throws for misuse and for bad input from outside; an expected "no result"
/// is a std::optional. Every message says what was wrong, where (file, line, key) and what to do about it.
namespace perennial {

/// Base of all exceptions thrown by this library.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A parameter is unknown, of the wrong type or out of its range. The message names the key and the range.
class ParameterError : public Error {
 public:
  using Error::Error;
};

/// A map file is missing, damaged, of another version or taught with other settings.
class MapError : public Error {
 public:
  using Error::Error;
};

/// A map of an older format could not be migrated to the present one, for want of room, say. It is as it was,
/// and can be read.
class MigrationError : public MapError {
 public:
  using MapError::MapError;
};

/// An image has another size or encoding than expected, or cannot be read.
class ImageError : public Error {
 public:
  using Error::Error;
};

/// A data set's manifest or one of its files is malformed. The message names file and line.
class DatasetError : public Error {
 public:
  using Error::Error;
};

}  // namespace perennial
