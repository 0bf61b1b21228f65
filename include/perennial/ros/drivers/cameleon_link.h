#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "perennial/core/drivers/cameleon_codec.h"
#include "perennial/core/drivers/cameleon_status_parser.h"
#include "perennial/core/parameter_reader.h"

namespace perennial {

struct CameleonLinkSettings {
  std::string host = "172.43.50.193";
  int port = 50004;
  double connect_timeout_s = 3.0;
  double reconnect_min_s = 0.2;  ///< pause before the next attempt; doubles with every failed one
  double reconnect_max_s = 5.0;

  /// Keys robot_host, robot_port, and as the other members are called. Throws ParameterError.
  static CameleonLinkSettings load(ParameterReader& reader);
};

/// The TCP connection to the robot: connects when the robot appears, again and again, and never blocks its
/// user.
///
/// After connecting it sends the handshake and one zero speed command by itself. Of the commands given to
/// send() only the newest goes out while an earlier one is still being written. Everything happens on one
/// thread of its own; the callbacks run there too, and must be quick.
class CameleonLink {
 public:
  struct Callbacks {
    std::function<void(const CameleonStatus&)> status;
    std::function<void(bool connected)> connection;
  };
  struct Counters {
    CameleonStatusParser::Counters parser;
    std::uint64_t connections = 0;
    std::string last_error;  ///< of the newest failed attempt or lost connection
  };

  CameleonLink(const CameleonLinkSettings& settings, const CameleonHandshake& handshake, Callbacks callbacks);
  /// Says goodbye by closing its own direction, and gives the robot a moment to read what was sent and to
  /// close the other one: closing at once, with a status unread, would reset the connection and could cost
  /// the last command.
  ~CameleonLink();
  CameleonLink(const CameleonLink&) = delete;
  CameleonLink& operator=(const CameleonLink&) = delete;

  /// Thread-safe. Ignored while not connected.
  void send(const CameleonCommand& command);
  /// Drops the connection and connects anew. Thread-safe.
  void restart(const std::string& reason);
  /// Sends this as the last command, and waits until it has been written or `timeout` is over. Thread-safe.
  void sendLast(const CameleonCommand& command, std::chrono::milliseconds timeout);

  Counters counters() const;

 private:
  using Tcp = boost::asio::ip::tcp;

  void connect();
  void connectTo(const Tcp::resolver::results_type& endpoints);
  void greet();
  void read();
  void parse(std::size_t size);
  void write();
  void disconnect(const std::string& reason);
  void retryLater();

  CameleonLinkSettings settings_;
  CameleonHandshake handshake_;
  Callbacks callbacks_;

  // Used on the link's thread only.
  boost::asio::io_context io_;
  Tcp::resolver resolver_{io_};
  Tcp::socket socket_{io_};
  boost::asio::steady_timer timer_{io_};
  std::array<std::uint8_t, 512> received_{};
  CameleonStatusParser parser_;
  bool connected_ = false;
  bool writing_ = false;
  std::optional<CameleonCommand> next_;
  CameleonCommandBytes being_written_{};
  std::uint64_t session_ = 0;  ///< handlers of an earlier connection see that it is another
  double pause_s_;

  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable changed_;
  Counters counters_;
  bool idle_ = true;  ///< nothing waits to be written
  bool open_ = false;

  std::thread thread_;
};

}  // namespace perennial
