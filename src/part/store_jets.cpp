// Compiles the functions of store_jets-inl.h once.
#include <pliant/part/store_jets-inl.h>
