#pragma once

namespace chromeball {

/// How many threads decode and encode files from now on, in the whole process (OpenEXR knows it
/// only so); 0: as many as processors may be used. Until it is called, one. To be called by
/// programs, beside core's ThreadLimit, and not while files are read or written.
void set_coding_threads(int threads);

}  // namespace chromeball
