// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <new>
#include <string>

#include "commands.h"
#include "console.h"
#include "lamina/core/error.h"

namespace {

// Exit codes: 0 done, 1 the work failed, 2 wrong use or wrong input, 130 interrupted.
int run(int argc, char** argv) {
  using namespace lamina::cli;
  CLI::App app("Light in layered translucent materials: predict and render.", "lamina");
  app.set_version_flag("--version", LAMINA_VERSION);
  app.require_subcommand(1);
  add_bsdf_command(app);
  add_maps_command(app);
  add_materials_command(app);
  add_merge_command(app);
  add_patch_command(app);
  add_photons_command(app);
  add_profile_command(app);
  add_render_command(app);
  add_slab_command(app);
  try {
    watch_for_interrupt();
    app.parse(argc, argv);
    return was_interrupted() ? 130 : 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    const bool is_unknown = argc > 1 && argv[1][0] != '-' && app.get_subcommands().empty();
    const auto commands = app.get_subcommands();
    const std::string help = commands.empty() ? "" : commands[0]->get_name() + " ";
    if (is_unknown)
      fmt::print(stderr, "lamina: there is no subcommand \"{}\"; see lamina --help\n", argv[1]);
    else
      fmt::print(stderr, "lamina: {}; see lamina {}--help\n", error.what(), help);
    return 2;
  } catch (const lamina::WriteError& error) {
    fmt::print(stderr, "lamina: {}\n", error.what());
    return 1;
  } catch (const lamina::Error& error) {
    fmt::print(stderr, "lamina: {}\n", error.what());
    return 2;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "lamina: not enough memory\n");
    return 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "lamina: {}\n", error.what());
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) { return run(argc, argv); }
