// What a parameter's schema allows, and what a person typed.

/** The kind of field a schema asks for. */
export function kindOf(schema) {
  if (schema.oneOf) {
    const number = schema.oneOf.find((one) => one.type === "number" || one.type === "integer");
    const words = schema.oneOf.find((one) => one.enum);
    if (number) return "number-or-off";
    if (words) return "words-or-text";
  }
  if (schema.enum) return "choice";
  if (schema.type === "boolean") return "switch";
  if (schema.type === "number" || schema.type === "integer") return "number";
  return "text";
}

/** [number, null] or [undefined, what is wrong]; empty is "not set" and good. */
export function readNumber(text, schema) {
  const trimmed = text.trim().replace(",", ".");
  if (trimmed === "") return schema.default === undefined ? [undefined, null] : [undefined, "A number is needed here."];
  const value = Number(trimmed);
  if (!Number.isFinite(value)) return [undefined, "This is not a number."];
  if (schema.type === "integer" && !Number.isInteger(value)) return [undefined, "A whole number is needed here."];
  if (schema.exclusiveMinimum !== undefined && value <= schema.exclusiveMinimum)
    return [undefined, `More than ${schema.exclusiveMinimum} is needed.`];
  if (schema.minimum !== undefined && value < schema.minimum)
    return [undefined, `At least ${schema.minimum} is needed.`];
  if (schema.maximum !== undefined && value > schema.maximum)
    return [undefined, `At most ${schema.maximum} is allowed.`];
  return [value, null];
}
