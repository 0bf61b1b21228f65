#pragma once

#include <termios.h>

#include <string>

namespace perennial {

/// The terminal on standard input, read key by key without waiting; restored at the end. Without a terminal,
/// as under roslaunch, there are no keys.
class Keyboard {
 public:
  Keyboard();
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  bool isThere() const { return is_there_; }
  /// The keys since the last call.
  std::string read();

 private:
  bool is_there_;
  termios before_{};
};

}  // namespace perennial
