#include "perennial/ros/drivers/cameleon_link.h"

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <memory>
#include <utility>

namespace perennial {
namespace {

using boost::system::error_code;

/// The robot looks at its socket once per loop of 40 ms.
constexpr std::chrono::milliseconds kGoodbye(300);

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1000.0));
}

}  // namespace

CameleonLinkSettings CameleonLinkSettings::load(ParameterReader& reader) {
  CameleonLinkSettings settings;
  settings.host = reader.text("robot_host", settings.host);
  settings.port = reader.integer("robot_port", settings.port, 1, 65535);
  settings.connect_timeout_s = reader.real("connect_timeout_s", settings.connect_timeout_s, 0.1, 60.0);
  settings.reconnect_min_s = reader.real("reconnect_min_s", settings.reconnect_min_s, 0.01, 60.0);
  settings.reconnect_max_s =
      reader.real("reconnect_max_s", std::max(settings.reconnect_max_s, settings.reconnect_min_s),
                  settings.reconnect_min_s, 600.0);
  return settings;
}

CameleonLink::CameleonLink(const CameleonLinkSettings& settings, const CameleonHandshake& handshake,
                           Callbacks callbacks)
    : settings_(settings),
      handshake_(handshake),
      callbacks_(std::move(callbacks)),
      pause_s_(settings.reconnect_min_s) {
  boost::asio::post(io_, [this] { connect(); });
  thread_ = std::thread([this] { io_.run(); });
}

CameleonLink::~CameleonLink() {
  boost::asio::post(io_, [this] {
    error_code ignored;
    socket_.shutdown(Tcp::socket::shutdown_send, ignored);
  });
  {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, kGoodbye, [this] { return !open_; });
  }
  io_.stop();
  thread_.join();
}

void CameleonLink::send(const CameleonCommand& command) {
  boost::asio::post(io_, [this, command] {
    if (connected_) {
      next_ = command;
      write();
    }
  });
}

void CameleonLink::restart(const std::string& reason) {
  boost::asio::post(io_, [this, reason] {
    if (connected_) {
      disconnect(reason);
    }
  });
}

void CameleonLink::sendLast(const CameleonCommand& command, std::chrono::milliseconds timeout) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    idle_ = false;
  }
  boost::asio::post(io_, [this, command] {
    next_ = command;
    write();
  });
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait_for(lock, timeout, [this] { return idle_; });
}

CameleonLink::Counters CameleonLink::counters() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return counters_;
}

void CameleonLink::connect() {
  const std::uint64_t session = ++session_;
  timer_.expires_after(milliseconds(settings_.connect_timeout_s));
  timer_.async_wait([this, session](const error_code& error) {
    if (!error && session == session_ && !connected_) {
      disconnect("no answer from " + settings_.host);
    }
  });
  resolver_.async_resolve(
      settings_.host, std::to_string(settings_.port),
      [this, session](const error_code& error, const Tcp::resolver::results_type& endpoints) {
        if (session != session_) {
          return;
        }
        if (error) {
          disconnect("cannot resolve " + settings_.host + ": " + error.message());
        } else {
          connectTo(endpoints);
        }
      });
}

void CameleonLink::connectTo(const Tcp::resolver::results_type& endpoints) {
  boost::asio::async_connect(socket_, endpoints,
                             [this, session = session_](const error_code& error, const Tcp::endpoint&) {
                               if (session != session_) {
                                 return;
                               }
                               if (error) {
                                 disconnect("cannot connect to " + settings_.host + ": " + error.message());
                               } else {
                                 greet();
                               }
                             });
}

void CameleonLink::greet() {
  timer_.cancel();
  error_code ignored;
  socket_.set_option(Tcp::no_delay(true), ignored);
  const CameleonHandshakeBytes hello = encode(handshake_);
  error_code error;
  boost::asio::write(socket_, boost::asio::buffer(hello),
                     error);  // four bytes always fit a new socket's buffer
  if (error) {
    disconnect(error.message());
    return;
  }
  parser_.reset();
  connected_ = true;
  pause_s_ = settings_.reconnect_min_s;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++counters_.connections;
    open_ = true;
    counters_.last_error.clear();
  }
  next_ = CameleonCommand{CameleonCommandType::kSpeed, 0, 0, 0};
  write();
  callbacks_.connection(true);
  read();
}

void CameleonLink::read() {
  socket_.async_read_some(boost::asio::buffer(received_),
                          [this, session = session_](const error_code& error, std::size_t size) {
                            if (session != session_) {
                              return;
                            }
                            if (error) {
                              disconnect(error.message());
                              return;
                            }
                            parse(size);
                            read();
                          });
}

void CameleonLink::parse(std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    if (const std::optional<CameleonStatus> status = parser_.push(received_[i])) {
      callbacks_.status(*status);
    }
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  counters_.parser = parser_.counters();
}

void CameleonLink::write() {
  if (writing_) {
    return;
  }
  if (!next_ || !connected_) {
    const std::lock_guard<std::mutex> lock(mutex_);
    idle_ = true;
    changed_.notify_all();
    return;
  }
  being_written_ = encode(*next_);
  next_.reset();
  writing_ = true;
  boost::asio::async_write(socket_, boost::asio::buffer(being_written_),
                           [this, session = session_](const error_code& error, std::size_t) {
                             writing_ = false;
                             if (session != session_) {
                               return;
                             }
                             if (error) {
                               disconnect(error.message());
                             } else {
                               write();
                             }
                           });
}

void CameleonLink::disconnect(const std::string& reason) {
  ++session_;
  error_code ignored;
  resolver_.cancel();
  timer_.cancel();
  socket_.close(ignored);
  next_.reset();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    counters_.last_error = reason;
    idle_ = true;
    open_ = false;
    changed_.notify_all();
  }
  if (connected_) {
    connected_ = false;
    callbacks_.connection(false);
  }
  retryLater();
}

void CameleonLink::retryLater() {
  timer_.expires_after(milliseconds(pause_s_));
  pause_s_ = std::min(2.0 * pause_s_, settings_.reconnect_max_s);
  timer_.async_wait([this, session = session_](const error_code& error) {
    if (!error && session == session_) {
      connect();
    }
  });
}

}  // namespace perennial
