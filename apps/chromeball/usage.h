#pragma once

#include <CLI/App.hpp>

#include <optional>
#include <string>

namespace chromeball {

/// What was typed wrong, and what was perhaps meant: for the words that the parser could not use.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error);

/// The first word like `--size=`, as a script writes it whose variable is empty; the parser would
/// take the next word for the value. Nothing where there is none.
std::optional<std::string> option_without_value(int argc, const char* const* argv);

/// For a word that names no option of the command: says so, with the nearest names.
std::string unknown_option(const CLI::App& command, const std::string& name);

}  // namespace chromeball
