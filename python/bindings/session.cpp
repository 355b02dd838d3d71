// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include "session.h"

#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "images.h"
#include "json_files.h"
#include "lamina/render/render_session.h"
#include "natives.h"
#include "work.h"

namespace lamina::python {
namespace {

namespace py = pybind11;

/// A RenderSession that lets Python go on while it waits.
class Session {
 public:
  Session(const std::string& path, const std::optional<std::string>& text,
          const std::vector<std::string>& settings)
      : session_(load_unlocked(json_file(path, text), [&](const JsonFile& file) {
          RenderSession::Options options;
          options.goes_on = false;
          return std::make_unique<RenderSession>(file, settings, std::move(options));
        })) {}
  ~Session() { close(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  std::uint64_t set(const std::vector<std::string>& settings) {
    RenderSession& session = open();
    const py::gil_scoped_release unlocked;
    return session.set(settings);
  }

  std::uint64_t set_region(const std::optional<std::array<int, 4>>& region) {
    RenderSession& session = open();
    const py::gil_scoped_release unlocked;
    if (!region) return session.set_region(std::nullopt);
    const auto& [x, y, width, height] = *region;
    return session.set_region(PixelRectangle{x, y, width, height});
  }

  py::dict picture(bool is_final, const py::object& callback) {
    RenderSession& session = open();
    Work work(callback);
    const auto shown = work.run([&](const Progress& progress) {
      auto found = session.wait_for(
          is_final ? RenderSession::Wait::final : RenderSession::Wait::any, progress);
      if (!found) throw Interrupted();
      return found;
    });
    py::dict result;
    result["change"] = shown->change;
    result["fraction"] = shown->fraction;
    result["is_first_look"] = shown->is_first_look;
    result["is_final"] = shown->is_final;
    result["samples_per_pixel"] = shown->samples_per_pixel;
    result["seconds"] = shown->seconds;
    result["channels"] = shown->image.channels;
    result["pixels"] = image_array(Image(shown->image));
    return result;
  }

  void close() {
    std::unique_ptr<RenderSession> ending = std::move(session_);
    const py::gil_scoped_release unlocked;
    ending.reset();
  }

 private:
  [[nodiscard]] RenderSession& open() const {
    if (!session_) throw InvalidInput("session: must be open, but was closed");
    return *session_;
  }
  std::unique_ptr<RenderSession> session_;
};

}  // namespace

void bind_session(py::module_& module) {
  native_class<Session>(module, "Session")
      .def("set", &Session::set)
      .def("set_region", &Session::set_region)
      .def("picture", &Session::picture)
      .def("close", &Session::close);
  module.def("open_session", [](const std::string& path, const std::optional<std::string>& text,
                                const std::vector<std::string>& settings) {
    return std::make_unique<Session>(path, text, settings);
  });
}

}  // namespace lamina::python
