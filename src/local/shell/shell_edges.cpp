// Compiles the functions of shell/shell_edges.h once for the library.
#include <pliant/local/shell/shell_edges-inl.h>
