#include "perennial/ros/drivers/keyboard.h"

#include <poll.h>
#include <unistd.h>

#include <array>

namespace perennial {

Keyboard::Keyboard() : is_there_(isatty(STDIN_FILENO) == 1 && tcgetattr(STDIN_FILENO, &before_) == 0) {
  if (is_there_) {
    termios keywise = before_;
    keywise.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    tcsetattr(STDIN_FILENO, TCSANOW, &keywise);
  }
}

Keyboard::~Keyboard() {
  if (is_there_) {
    tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
}

std::string Keyboard::read() {
  std::string keys;
  pollfd input{STDIN_FILENO, POLLIN, 0};
  std::array<char, 64> buffer;
  while (is_there_ && poll(&input, 1, 0) == 1 && (input.revents & POLLIN) != 0) {
    const ssize_t size = ::read(STDIN_FILENO, buffer.data(), buffer.size());
    if (size <= 0) {
      is_there_ = false;  // the terminal was closed
      break;
    }
    keys.append(buffer.data(), static_cast<std::size_t>(size));
  }
  return keys;
}

}  // namespace perennial
