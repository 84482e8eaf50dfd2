#include "io/threads.h"

#include <OpenEXR/ImfThreading.h>

#include <algorithm>
#include <thread>

namespace chromeball {

void set_coding_threads(int threads) {
    if (threads == 0) threads = static_cast<int>(std::thread::hardware_concurrency());
    // None: the calling thread does it.
    Imf::setGlobalThreadCount(threads > 1 ? threads : 0);
}

}  // namespace chromeball
