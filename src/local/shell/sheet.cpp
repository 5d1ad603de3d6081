// Compiles the functions of shell/sheet.h once for the library.
#include <pliant/local/shell/sheet-inl.h>
