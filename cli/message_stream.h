// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace lamina::cli {

/// Lines from a file descriptor and to another, both left open.
class MessageStream {
 public:
  /// Longer lines are refused [bytes].
  static constexpr std::size_t longest = std::size_t{1} << 20;

  MessageStream(int in, int out) : in_(in), out_(out) {}

  enum class Got { line, too_long, nothing_yet, end };
  /// The next line without its end, of what was read so far; `too_long` once for a line that is.
  [[nodiscard]] Got next(std::string& line);
  /// Waits until there is more to read, or until `wake` can be read. @return  false at the end
  [[nodiscard]] bool wait(int wake, int milliseconds = -1);
  /// @return  false where nobody reads any more
  bool write(const std::string& line) const;

 private:
  int in_, out_;
  std::string read_;
  std::size_t searched_ = 0;
  bool is_skipping_ = false, is_at_end_ = false;
};

/// A socket that listens on the loopback address 127.0.0.1 alone.
class LoopbackListener {
 public:
  /// @param port  0: any that is free
  /// @throws InvalidInput if it cannot be had
  explicit LoopbackListener(int port);
  ~LoopbackListener();
  LoopbackListener(const LoopbackListener&) = delete;
  LoopbackListener& operator=(const LoopbackListener&) = delete;

  [[nodiscard]] int port() const { return port_; }
  /// Waits for a client. @return  its socket, to be closed by the caller
  [[nodiscard]] int accept_client() const;

 private:
  int socket_ = -1, port_ = 0;
};

/// 32 hexadecimal digits that nobody can guess.
[[nodiscard]] std::string random_token();

/// Whether two texts are equal, in a time that does not say how far they are.
[[nodiscard]] bool is_same_secret(const std::string& a, const std::string& b);

}  // namespace lamina::cli
