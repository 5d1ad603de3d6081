// Compiles the functions of shell/shell_mesh.h once for the library.
#include <pliant/local/shell/shell_mesh-inl.h>
