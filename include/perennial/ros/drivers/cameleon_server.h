#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "perennial/core/drivers/cameleon_codec.h"

namespace perennial {

/// The robot's end of the TCP connection, for the simulator: one client at a time, polled, never waiting.
class CameleonServer {
 public:
  /// Listens on this address of the computer ("0.0.0.0": on all); port 0 takes a free one. Throws Error when
  /// the address is none or the port is taken.
  CameleonServer(std::string address, int port);

  int port() const { return port_; }

  /// What the client has sent since the last call.
  struct Received {
    std::optional<CameleonHandshake> handshake;  ///< when a client has just said hello
    std::vector<CameleonCommand> commands;
    std::uint64_t bad_commands = 0;
  };
  Received poll();

  /// Dropped when there is no client, or when it does not read.
  void send(const std::vector<std::uint8_t>& bytes);

  void closeClient();
  /// While refused, nobody can connect.
  void refuseClients(bool refuse);
  bool hasClient() const { return has_client_; }

 private:
  void listen();
  void acceptClient();
  void receive();
  void take(Received& received);

  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_{io_};
  boost::asio::ip::tcp::socket client_{io_};
  std::string address_;
  int port_;
  bool has_client_ = false;
  bool greeted_ = false;
  std::deque<std::uint8_t> bytes_;
};

}  // namespace perennial
