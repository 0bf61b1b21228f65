#include "perennial/ros/drivers/cameleon_server.h"

#include <algorithm>
#include <array>
#include <boost/asio/ip/address.hpp>
#include <utility>

#include "perennial/core/error.h"

namespace perennial {
namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;

template <std::size_t size>
std::array<std::uint8_t, size> takeFront(std::deque<std::uint8_t>& bytes) {
  std::array<std::uint8_t, size> taken;
  const auto end = bytes.begin() + static_cast<std::ptrdiff_t>(size);
  std::copy(bytes.begin(), end, taken.begin());
  bytes.erase(bytes.begin(), end);
  return taken;
}

}  // namespace

CameleonServer::CameleonServer(std::string address, int port) : address_(std::move(address)), port_(port) {
  listen();
}

void CameleonServer::listen() {
  try {
    const tcp::endpoint endpoint(boost::asio::ip::make_address(address_), static_cast<unsigned short>(port_));
    acceptor_ = tcp::acceptor(io_, endpoint, true);
    acceptor_.non_blocking(true);
    port_ = acceptor_.local_endpoint().port();
  } catch (const boost::system::system_error& error) {
    throw Error("cannot listen on " + address_ + ", port " + std::to_string(port_) + ": " + error.what());
  }
}

CameleonServer::Received CameleonServer::poll() {
  acceptClient();
  Received received;
  if (has_client_) {
    receive();
    take(received);
  }
  return received;
}

void CameleonServer::acceptClient() {
  if (!acceptor_.is_open()) {
    return;
  }
  tcp::socket newcomer(io_);
  error_code error;
  acceptor_.accept(newcomer, error);
  if (error) {
    return;
  }
  closeClient();
  client_ = std::move(newcomer);
  client_.non_blocking(true, error);
  client_.set_option(tcp::no_delay(true), error);
  has_client_ = true;
}

void CameleonServer::receive() {
  std::array<std::uint8_t, 1024> buffer;
  error_code error;
  while (has_client_) {
    const std::size_t size = client_.read_some(boost::asio::buffer(buffer), error);
    if (error == boost::asio::error::would_block) {
      return;
    }
    if (error) {
      // The last commands came before the end of the stream and still count.
      client_.close(error);
      has_client_ = false;
      return;
    }
    bytes_.insert(bytes_.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size));
  }
}

void CameleonServer::take(Received& received) {
  if (!greeted_ && bytes_.size() >= kCameleonHandshakeSize) {
    received.handshake = decodeHandshake(takeFront<kCameleonHandshakeSize>(bytes_));
    greeted_ = true;
    if (!received.handshake) {
      closeClient();
      return;
    }
  }
  while (greeted_ && bytes_.size() >= kCameleonCommandSize) {
    if (const auto command = decodeCommand(takeFront<kCameleonCommandSize>(bytes_))) {
      received.commands.push_back(*command);
    } else {
      ++received.bad_commands;
    }
  }
}

void CameleonServer::send(const std::vector<std::uint8_t>& bytes) {
  if (has_client_ && greeted_) {
    error_code ignored;
    client_.write_some(boost::asio::buffer(bytes), ignored);
  }
}

void CameleonServer::closeClient() {
  error_code ignored;
  client_.close(ignored);
  has_client_ = false;
  greeted_ = false;
  bytes_.clear();
}

void CameleonServer::refuseClients(bool refuse) {
  if (refuse && acceptor_.is_open()) {
    acceptor_.close();
  } else if (!refuse && !acceptor_.is_open()) {
    listen();
  }
}

}  // namespace perennial
