#include "sheetform/decompose.h"
