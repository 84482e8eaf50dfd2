#pragma once

#include <string>
#include <vector>

#include "shot/farm.h"

namespace chromeball {

/// Runs a program found on the path, without a shell, with a text as its standard input, and waits
/// for it. Status 127 where there is none, 128 + N where signal N ended it. Throws Error when the
/// system lets nothing be started.
ProgramOutcome run_program(const std::vector<std::string>& words, const std::string& input);

/// The words this program was started with, behind its name.
std::vector<std::string> typed_words();

/// Where this program lies: absolute, symbolic links followed.
std::string program_path();

}  // namespace chromeball
