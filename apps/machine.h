// Texts about the machine and the linked libraries.
#pragma once

#include <string>
#include <vector>

namespace pliant_cli {

/// Returns the instruction sets among sse4.2, avx, avx2, fma and avx512f that the processor has, for example
/// "avx avx2 fma". Returns an empty text on processors other than x86-64.
std::string processor_features();
/// Returns the file names in /proc/self/maps that contain "blas", separated by blanks. These are the BLAS
/// libraries loaded into this process. Returns "none" if there are none or the system is not Linux.
std::string loaded_blas();
/// Returns the path of the first executable file with this name in the folders of PATH; empty if there is
/// none.
std::string find_program(const std::string& name);

/// Returns the text that pliant --version prints.
std::string version_text();

}  // namespace pliant_cli
