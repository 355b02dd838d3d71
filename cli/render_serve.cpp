// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// `lamina serve`: a scene that stays, and is changed and looked at by messages (docs/serve.md).
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <chrono>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "console.h"
#include "lamina/base/core/error.h"
#include "lamina/base/image/files/image_file.h"
#include "lamina/base/image/tone.h"
#include "lamina/base/io/base64.h"
#include "lamina/base/io/file_bytes.h"
#include "lamina/base/io/json_input.h"
#include "lamina/render/render_session.h"
#include "message_stream.h"

namespace lamina::cli {
namespace {

using Wait = RenderSession::Wait;

struct ServeOptions {
  CommonOptions common;
  std::string scene, token_file;
  std::vector<std::string> settings;
  int port = -1;
};

/// Pictures, notices and errors of a session's threads, queued for the thread that talks to the
/// client.
class News {
 public:
  News() {
    if (pipe2(pipe_.data(), O_CLOEXEC | O_NONBLOCK) != 0)
      throw InvalidInput("no pipe can be had: " + std::string(std::strerror(errno)));
  }
  ~News() {
    for (const int end : pipe_) close(end);
  }
  News(const News&) = delete;
  News& operator=(const News&) = delete;

  [[nodiscard]] int wake() const { return pipe_[0]; }

  void add(JsonOutput event) {
    {
      const std::scoped_lock lock(mutex_);
      constexpr std::size_t most = 256;  // to a client that does not read
      if (events_.size() < most) events_.push_back(std::move(event));
    }
    ring();
  }
  void add_picture() { ring(); }

  [[nodiscard]] std::vector<JsonOutput> take() {
    std::array<char, 64> bytes;
    while (read(pipe_[0], bytes.data(), bytes.size()) > 0) {
    }
    const std::scoped_lock lock(mutex_);
    return std::exchange(events_, {});
  }

 private:
  void ring() const { [[maybe_unused]] const ssize_t full = write(pipe_[1], "", 1); }

  std::array<int, 2> pipe_{};
  std::mutex mutex_;
  std::vector<JsonOutput> events_;
};

enum class Format { png, exr, raw };

/// A `get` that waits for its picture.
struct Request {
  JsonOutput id;
  Format format = Format::png;
  Wait wait = Wait::any;
  bool is_waiting = false;
};

std::string encoded(const SessionPicture& picture, Format format) {
  if (format == Format::exr) return base64(encode_exr(picture.image));
  if (format == Format::png)
    return base64(encode_png(view_image(picture.image, picture.film.view,
                                        static_cast<double>(picture.film.exposure))));
  static_assert(std::endian::native == std::endian::little);
  const Image colors = select_channels(picture.image, {"R", "G", "B"});
  return base64(std::as_bytes(std::span(colors.pixels)));
}

JsonOutput described(const SessionPicture& picture) {
  JsonOutput json = {{"change", picture.change},
                     {"fraction", picture.fraction},
                     {"width", picture.image.width},
                     {"height", picture.image.height},
                     {"samples_per_pixel", picture.samples_per_pixel},
                     {"is_first_look", picture.is_first_look},
                     {"is_final", picture.is_final},
                     {"seconds", picture.seconds}};
  json["film"] = JsonOutput::array({picture.film.width, picture.film.height});
  if (const auto& region = picture.film.region)
    json["region"] = JsonOutput::array({region->x, region->y, region->width, region->height});
  return json;
}

/// One client of a session.
class Conversation {
 public:
  Conversation(RenderSession& session, News& news, MessageStream& stream)
      : session_(session), news_(news), stream_(stream) {}

  enum class End { client_left, quit };
  /// Answers messages until the client leaves.
  End hold() {
    std::string line;
    while (true) {
      for (auto got = stream_.next(line); got != MessageStream::Got::nothing_yet;
           got = stream_.next(line)) {
        if (got == MessageStream::Got::end) return End::client_left;
        if (got == MessageStream::Got::too_long)
          refuse(nullptr, fmt::format("message: must be at most {} bytes long, but is longer",
                                      MessageStream::longest));
        else if (line.find_first_not_of(" \t\r") != std::string::npos)
          answer(line);
        if (has_quit_) return End::quit;
        if (is_broken_) return End::client_left;
      }
      tell_news();
      if (is_broken_ || !stream_.wait(news_.wake())) return End::client_left;
    }
  }

 private:
  void write(const JsonOutput& message) {
    if (!stream_.write(message.text())) is_broken_ = true;
  }
  void refuse(const JsonOutput& id, const std::string& why) { write({{"id", id}, {"error", why}}); }

  void answer(const std::string& line) {
    JsonOutput id;
    try {
      const JsonDocument document = parse_json(line, "message");
      const JsonInput root = document.root();
      if (const auto given = root.is_object() ? root.peek("id") : std::nullopt) {
        if (!given->is_string() && !given->is_number() && !given->is_null())
          given->refuse("must be text or a number");
        id = JsonOutput(*given);
      }
      act(root, id);
    } catch (const Error& error) {
      refuse(id, error.what());
    }
  }

  void act(const JsonInput& root, const JsonOutput& id) {
    const auto to_do = root.is_object() ? root.peek("do") : std::nullopt;
    if (!to_do) root.fail("a message is an object that has \"do\"");
    using Act = void (Conversation::*)(const JsonInput&, const JsonOutput&);
    const Act chosen = to_do->choice<Act>({{"set", &Conversation::set},
                                        {"camera", &Conversation::move_camera},
                                        {"region", &Conversation::set_region},
                                        {"reload", &Conversation::reload},
                                        {"get", &Conversation::get},
                                        {"events", &Conversation::choose_events},
                                        {"cancel", &Conversation::cancel},
                                        {"status", &Conversation::status},
                                        {"quit", &Conversation::quit}});
    (this->*chosen)(root, id);
  }

  void done(const JsonOutput& id, std::uint64_t change) {
    JsonOutput reply = {{"id", id}, {"change", change}};
    if (const auto warnings = session_.status().warnings; !warnings.empty())
      reply["warnings"] = warnings;
    write(reply);
  }

  void set(const JsonInput& root, const JsonOutput& id) {
    const JsonObject message = root.object({"id", "do", "values"});
    std::vector<std::string> settings;
    for (const auto& [path, value] : message.required("values").entries()) {
      if (path.empty() || path.find('=') != std::string::npos)
        value.fail("a path has no \"=\" and is not empty");
      settings.push_back(path + "=" + JsonOutput(value).text());
    }
    done(id, session_.set(settings));
  }

  void move_camera(const JsonInput& root, const JsonOutput& id) {
    const JsonObject message = root.object({"id", "do", "position", "look_at", "up",
                                            "horizontal_fov", "aperture_diameter",
                                            "focus_distance"});
    std::vector<std::string> settings;
    for (const char* key : {"position", "look_at", "up", "horizontal_fov", "aperture_diameter",
                            "focus_distance"})
      if (const auto value = message.optional(key))
        settings.push_back(fmt::format("camera.{}={}", key, JsonOutput(*value).text()));
    done(id, session_.set(settings));
  }

  void set_region(const JsonInput& root, const JsonOutput& id) {
    const JsonInput region = root.object({"id", "do", "region"}).required("region");
    if (region.is_null()) return done(id, session_.set_region(std::nullopt));
    constexpr std::int64_t most = 16384;
    const std::vector<JsonInput> numbers = region.array(4, 4);
    const auto number = [&](std::size_t i, std::int64_t least) {
      return static_cast<int>(numbers[i].integer(least, most));
    };
    const PixelRectangle wanted{
        .x = number(0, 0), .y = number(1, 0), .width = number(2, 1), .height = number(3, 1)};
    done(id, session_.set_region(wanted));
  }

  void reload(const JsonInput& root, const JsonOutput& id) {
    (void)root.object({"id", "do"});
    done(id, session_.reload());
  }

  void get(const JsonInput& root, const JsonOutput& id) {
    const JsonObject message = root.object({"id", "do", "format", "wait"});
    Request request{.id = id};
    if (const auto format = message.optional("format"))
      request.format = format->choice<Format>(
          {{"png", Format::png}, {"exr", Format::exr}, {"raw", Format::raw}});
    if (const auto wait = message.optional("wait")) {
      enum class Until { nothing, any, final };
      const Until until = wait->choice<Until>(
          {{"none", Until::nothing}, {"any", Until::any}, {"final", Until::final}});
      request.is_waiting = until != Until::nothing;
      request.wait = until == Until::final ? Wait::final : Wait::any;
    }
    constexpr std::size_t most = 64;
    if (waiting_.size() >= most)
      root.fail("at most " + std::to_string(most) + " pictures can be waited for at a time");
    if (!serve(request)) waiting_.push_back(std::move(request));
  }

  void choose_events(const JsonInput& root, const JsonOutput& id) {
    const JsonObject message = root.object({"id", "do", "format"});
    const JsonInput format = message.required("format");
    event_format_.reset();
    has_events_ = !format.is_null();
    if (has_events_ && !(format.is_string() && format.string() == "none"))
      event_format_ = format.choice<Format>(
          {{"png", Format::png}, {"exr", Format::exr}, {"raw", Format::raw}});
    write({{"id", id}, {"events", has_events_}});
  }

  void cancel(const JsonInput& root, const JsonOutput& id) {
    (void)root.object({"id", "do"});
    session_.cancel();
    for (const Request& request : std::exchange(waiting_, {})) refuse(request.id, "cancelled");
    done(id, session_.status().change);
  }

  void status(const JsonInput& root, const JsonOutput& id) {
    (void)root.object({"id", "do"});
    const RenderSession::Status status = session_.status();
    JsonOutput reply = {{"id", id}, {"change", status.change}, {"is_working", status.is_working}};
    if (!status.error.empty()) reply["scene_error"] = status.error;
    reply["warnings"] = status.warnings;
    if (const auto picture = session_.picture()) reply["picture"] = described(*picture);
    reply["waiting"] = waiting_.size();
    write(reply);
  }

  void quit(const JsonInput& root, const JsonOutput& id) {
    (void)root.object({"id", "do"});
    has_quit_ = true;
    done(id, session_.status().change);
  }

  /// Answers a request, if that is possible already.
  bool serve(const Request& request) {
    const RenderSession::Status now = session_.status();
    const auto picture = session_.picture();
    const bool is_current = picture && picture->change == now.change;
    if (!(request.is_waiting
              ? is_current && (request.wait == Wait::any || picture->is_final)
              : picture != nullptr)) {
      if (now.error.empty() && request.is_waiting) return false;
      refuse(request.id, now.error.empty() ? "there is no picture yet" : now.error);
      return true;
    }
    JsonOutput reply = {{"id", request.id}};
    reply["picture"] = described(*picture);
    add_data(*picture, request.format, reply);
    write(reply);
    return true;
  }

  static void add_data(const SessionPicture& picture, Format format, JsonOutput& reply) {
    reply["format"] = format == Format::png ? "png" : format == Format::exr ? "exr" : "raw";
    reply["data"] = encoded(picture, format);
  }

  void tell_news() {
    for (const JsonOutput& event : news_.take())
      if (has_events_) write(event);
    const auto picture = session_.picture();
    if (has_events_ && picture && picture != told_) {
      JsonOutput event = {{"event", "picture"}};
      event["picture"] = described(*picture);
      if (event_format_) add_data(*picture, *event_format_, event);
      write(event);
    }
    told_ = picture;
    std::erase_if(waiting_, [&](const Request& request) { return serve(request); });
  }

  RenderSession& session_;
  News& news_;
  MessageStream& stream_;
  std::vector<Request> waiting_;
  std::shared_ptr<const SessionPicture> told_;
  std::optional<Format> event_format_;
  bool has_events_ = false, has_quit_ = false, is_broken_ = false;
};

/// The token that clients must know: of the file, or a new one.
std::string token_of(const ServeOptions& options) {
  if (options.token_file.empty()) return random_token();
  std::string token = read_file_bytes(options.token_file);
  token = token.substr(0, token.find_first_of("\r\n"));
  constexpr std::size_t least = 16;
  if (token.size() < least)
    throw InvalidInput(fmt::format("--token-file: {}: the token must have at least {} letters, "
                                   "but has {}",
                                   options.token_file, least, token.size()));
  return token;
}

/// Whether a client says the token, in its first line and soon.
bool knows_token(MessageStream& stream, const std::string& token) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  std::string line;
  while (std::chrono::steady_clock::now() < deadline) {
    const auto got = stream.next(line);
    if (got == MessageStream::Got::nothing_yet) {
      if (!stream.wait(-1, 500)) return false;
      continue;
    }
    if (got != MessageStream::Got::line) return false;
    try {
      const JsonDocument document = parse_json(line, "message");
      return is_same_secret(document.root().object({"token"}).required("token").string(), token);
    } catch (const Error&) {
      return false;
    }
  }
  return false;
}

void serve_clients(const ServeOptions& options, RenderSession& session, News& news) {
  const std::string token = token_of(options);
  const LoopbackListener listener(options.port);
  JsonOutput ready = make_result("serve");
  ready["port"] = listener.port();
  if (options.token_file.empty()) ready["token"] = token;
  write_output(ready.text() + "\n");
  while (true) {
    const int client = listener.accept_client();
    MessageStream stream(client, client);
    auto end = Conversation::End::client_left;
    if (knows_token(stream, token)) {
      stream.write(R"({"welcome":true})");
      end = Conversation(session, news, stream).hold();
    } else {
      stream.write(R"({"error":"the first line must be {\"token\": TOKEN} with the right token"})");
    }
    close(client);
    if (end == Conversation::End::quit) return;
  }
}

void run_serve(const ServeOptions& options) {
  if (!options.token_file.empty() && options.port < 0)
    throw InvalidInput("--token-file: goes with --port, which is not given");
  if (options.scene == "-")
    throw InvalidInput("the scene must be a file, for standard input has the messages");
  (void)signal(SIGPIPE, SIG_IGN);
  News news;
  RenderSession::Options how{.memory = options.common.memory};
  how.seconds_between_pictures = 0.25;
  how.on_picture = [&](const SessionPicture&) { news.add_picture(); };
  how.on_notice = [&](const std::string& line) {
    news.add({{"event", "notice"}, {"text", line}});
  };
  how.on_error = [&](const std::string& line) {
    news.add({{"event", "error"}, {"error", line}});
  };
  RenderSession session(JsonFile(options.scene), options.settings, std::move(how));
  rest_between_works();  // Ctrl-C ends at once
  if (options.port >= 0) return serve_clients(options, session, news);
  JsonOutput ready = make_result("serve");
  ready["scene"] = options.scene;
  write_output(ready.text() + "\n");
  MessageStream stream(STDIN_FILENO, STDOUT_FILENO);
  (void)Conversation(session, news, stream).hold();
}

}  // namespace

void add_serve_command(CLI::App& app) {
  auto options = std::make_shared<ServeOptions>();
  const Command command(app, "serve",
                        "Renders a scene that stays and is changed by messages, a line of JSON "
                        "each.");
  command.add_option("scene", options->scene, "scene file").type_name("SCENE").required();
  add_settings_option(command, options->settings, "scene");
  command
      .add_option("--port", options->port,
                  "listens on this port of 127.0.0.1, 0 for any that is free, for one client at a "
                  "time, whose first line must be {\"token\": TOKEN}; without the option messages "
                  "come by standard input")
      .type_name("N")
      .range(0, 65535);
  command
      .add_option("--token-file", options->token_file,
                  "file whose first line is the token; else one is made and printed")
      .type_name("FILE");
  add_common_options(command, options->common);
  command.footer(
      "Messages: docs/serve.md.\n"
      "Example: lamina serve scenes/sphere_skin.json\n"
      "  {\"id\": 1, \"do\": \"set\", \"values\": {\"camera.horizontal_fov\": 20}}\n"
      "  {\"id\": 2, \"do\": \"get\", \"format\": \"png\", \"wait\": \"any\"}");
  command.callback([options] { run_serve(*options); });
}

}  // namespace lamina::cli
