// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace lamina::cli {

// Each adds one subcommand: its options, its help with an example, and what it does when chosen.
// One file each: parse, call the library, print.
void add_bsdf_command(CLI::App& app);
void add_acquire_command(CLI::App& app);
void add_completion_command(CLI::App& app);
void add_edit_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_filters_command(CLI::App& app);
void add_fit_command(CLI::App& app);
void add_import_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_invert_command(CLI::App& app);
void add_maps_command(CLI::App& app);
void add_materials_command(CLI::App& app);
void add_merge_command(CLI::App& app);
void add_patch_command(CLI::App& app);
void add_photons_command(CLI::App& app);
void add_profile_command(CLI::App& app);
void add_render_command(CLI::App& app);
void add_reproduce_command(CLI::App& app);
void add_serve_command(CLI::App& app);
void add_slab_command(CLI::App& app);
void add_status_command(CLI::App& app);
void add_submit_command(CLI::App& app);

}  // namespace lamina::cli
