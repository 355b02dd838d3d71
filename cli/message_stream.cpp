// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "message_stream.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "lamina/base/core/error.h"

namespace lamina::cli {

MessageStream::Got MessageStream::next(std::string& line) {
  const std::size_t end = read_.find('\n', searched_);
  if (end == std::string::npos) {
    searched_ = read_.size();
    if (read_.size() > longest) {
      read_.clear();
      searched_ = 0;
      if (!is_skipping_) {
        is_skipping_ = true;
        return Got::too_long;
      }
    }
    if (!is_at_end_) return Got::nothing_yet;
    if (read_.empty() || is_skipping_) return Got::end;
    line = std::move(read_);  // a last line without its end
    read_.clear();
    return Got::line;
  }
  line = read_.substr(0, end);
  read_.erase(0, end + 1);
  searched_ = 0;
  if (is_skipping_) {
    is_skipping_ = false;
    return next(line);
  }
  if (line.size() > longest) return Got::too_long;
  if (line.ends_with('\r')) line.pop_back();
  return Got::line;
}

bool MessageStream::wait(int wake, int milliseconds) {
  std::array<pollfd, 2> polled = {{{in_, POLLIN, 0}, {wake, POLLIN, 0}}};
  if (poll(polled.data(), wake < 0 ? 1 : 2, milliseconds) < 0) return errno == EINTR;
  if ((polled[0].revents & (POLLIN | POLLHUP | POLLERR)) == 0) return true;
  std::array<char, 65536> bytes;
  const ssize_t count = read(in_, bytes.data(), bytes.size());
  if (count < 0 && (errno == EINTR || errno == EAGAIN)) return true;
  if (count <= 0) {
    const bool is_new = !is_at_end_;
    is_at_end_ = true;
    return is_new && !read_.empty();
  }
  read_.append(bytes.data(), static_cast<std::size_t>(count));
  return true;
}

bool MessageStream::write(const std::string& line) const {
  const std::string text = line + '\n';
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t count = ::write(out_, text.data() + at, text.size() - at);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    at += static_cast<std::size_t>(count);
  }
  return true;
}

LoopbackListener::LoopbackListener(int port) {
  const auto refuse = [&] {
    const std::string why = std::strerror(errno);
    if (socket_ >= 0) close(socket_);
    throw InvalidInput(fmt::format("--port: {} cannot be listened on: {}", port, why));
  };
  socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket_ < 0) refuse();
  const int on = 1;
  (void)setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(socket_, 4) != 0)
    refuse();
  socklen_t size = sizeof address;
  if (getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0) refuse();
  port_ = ntohs(address.sin_port);
}

LoopbackListener::~LoopbackListener() { close(socket_); }

int LoopbackListener::accept_client() const {
  while (true) {
    const int client = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client >= 0) return client;
    if (errno != EINTR && errno != ECONNABORTED)
      throw InvalidInput(fmt::format("--port: no client can be taken: {}", std::strerror(errno)));
  }
}

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw InvalidInput("--port: no random numbers for a token: " +
                       std::string(std::strerror(errno)));
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool is_same_secret(const std::string& a, const std::string& b) {
  unsigned different = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i)
    different |= static_cast<unsigned char>(a[i]) ^
                 static_cast<unsigned char>(i < b.size() ? b[i] : '\0');
  return different == 0;
}

}  // namespace lamina::cli
