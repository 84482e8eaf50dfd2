#pragma once

#include <CLI/App.hpp>

namespace chromeball {

// Each adds one subcommand: its options, help, and what runs when it is chosen. Add a command here,
// in main.cpp, and in a file of its name.
void add_detect(CLI::App& app);
void add_convert(CLI::App& app);
void add_info(CLI::App& app);
void add_shot(CLI::App& app);
void add_merge(CLI::App& app);
void add_preview(CLI::App& app);
void add_bake(CLI::App& app);
void add_stitch(CLI::App& app);
void add_calibrate(CLI::App& app);

}  // namespace chromeball
