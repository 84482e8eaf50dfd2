#pragma once

#include <string>

namespace chromeball {

/// A library that is loaded when it is first needed, because what stands behind it takes long to
/// load: its handle for dlsym(), or nullptr and the loader's words in `reason`.
///
/// Looked for on the run path of the program or library that holds this code. Stays loaded.
void* load_module(const std::string& name, std::string& reason);

/// The address of what a module exports under a name; nullptr where it has nothing of that name.
void* module_symbol(void* module, const std::string& name);

}  // namespace chromeball
